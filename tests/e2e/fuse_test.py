# SPDX-License-Identifier: Apache-2.0
"""`localize --fuse` of the real floorloc-mapbuilder, on the sample drive with two kidnaps and one wheel slip."""

import csv
import json
import math
import shutil
import unittest
from pathlib import Path

from builder import Scratch, run, run_ok

SAMPLE = Path(__file__).resolve().parents[2] / "maps" / "sample"
DRIVE = SAMPLE / "kidnap"
FRAMES = 100
KIDNAPS = 2


def lines(file):
    return [json.loads(line) for line in file.read_text().splitlines()]


def tum(file):
    return [list(map(float, line.split())) for line in file.read_text().splitlines() if not line.startswith("#")]


class Fused(Scratch):
    """Builds one map of the sample floor in the ground truth's frame."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.map = cls.root / "sample.floormap"
        run_ok("build", "--survey", SAMPLE / "survey", "--out", cls.map,
               "--poses", SAMPLE / "survey" / "groundtruth.tum")

    def fuse(self, *arguments, frames=DRIVE):
        """Poses, results and output of a run."""
        out, results = self.folder / "fused.tum", self.folder / "results.jsonl"
        printed = run_ok("localize", "--map", self.map, "--frames", frames, "--out", out, "--results", results,
                         "--fuse", *arguments)
        return out, lines(results), printed

    def rmse_m(self, estimate, truth=DRIVE / "groundtruth.tum", max_diff=0.001):
        return json.loads(run_ok("evaluate", "ape", truth, estimate, "--json", "--max-diff",
                                 max_diff))["translation"]["rmse"]

    def without(self, *names):
        """A copy of the drive without some of its files."""
        folder = self.folder / "drive"
        shutil.copytree(DRIVE, folder, ignore=shutil.ignore_patterns(*names))
        return folder

    def test_relocalizes_the_vehicle_and_reports_no_wrong_pose(self):
        out, results, printed = self.fuse()
        self.assertEqual(len(results), FRAMES)
        self.assertEqual(sum(result.get("reanchored", False) for result in results), KIDNAPS)
        self.assertIn(f"relocalized elsewhere {KIDNAPS} times", printed)
        self.assertGreaterEqual(len(tum(out)), FRAMES - 3 * KIDNAPS)
        self.assertLess(self.rmse_m(out), 1.5e-3)

    def test_says_at_each_frame_what_became_of_it(self):
        _, results, _ = self.fuse("--no-imu")  # the IMU would detect it at once
        with open(DRIVE / "events.csv", newline="") as file:
            kidnaps = [float(row["timestamp"]) for row in csv.DictReader(file) if row["event"] == "kidnap"]
        for time_s in kidnaps:
            first, second, third = [result for result in results if result["timestamp"] > time_s][:3]
            self.assertFalse(first["accepted"])
            self.assertIn(first["reject_reason"], ("jump_distance", "jump_angle"))
            self.assertTrue(first["fused"]["in_doubt"])
            self.assertEqual(second["fused"]["state"], "lost")
            self.assertTrue(third["reanchored"])
            self.assertEqual(third["fused"]["state"], "localized")
            self.assertEqual(third["fused"]["since_fix"]["metres"], 0.0)

    def check_drive(self, frames):
        """Exit code and findings by what they are about."""
        result = run("check-drive", "--map", self.map, "--frames", frames, "--json")
        return result.returncode, {f["about"]: f for f in json.loads(result.stdout)["findings"]}

    def test_check_drive_names_wheels_that_run_backward(self):
        code, findings = self.check_drive(DRIVE)
        self.assertEqual(code, 0, findings)
        self.assertEqual({f["status"] for f in findings.values()}, {"ok"}, findings)
        folder = self.without("odometry.tum")
        # Mirrored twice: the same turns, and motion backward.
        rows = [row.split() for row in (DRIVE / "odometry.tum").read_text().splitlines() if not row.startswith("#")]
        (folder / "odometry.tum").write_text(
            "".join(" ".join([t, str(-float(x)), str(-float(y)), *rest]) + "\n" for t, x, y, *rest in rows))
        code, findings = self.check_drive(folder)
        self.assertEqual(code, 3)
        self.assertEqual(findings["odometry"]["status"], "wrong")
        self.assertIn("change the sign of dx and dy", findings["odometry"]["cure"])
        self.assertEqual(findings["gyro"]["status"], "ok")

    def test_odometry_of_another_epoch_is_named_and_not_fused(self):
        folder = self.without("odometry.tum")
        rows = [row.split() for row in (DRIVE / "odometry.tum").read_text().splitlines() if not row.startswith("#")]
        start = float(rows[0][0])
        (folder / "odometry.tum").write_text(
            "".join(" ".join([f"{float(t) - start + 40.0:.6f}", *rest]) + "\n" for t, *rest in rows))
        code, findings = self.check_drive(folder)
        self.assertEqual(code, 3)
        self.assertEqual(findings["clock"]["status"], "wrong")
        self.assertRegex(findings["clock"]["sentence"], r"^images are stamped from \S+ to \S+ s, odometry from 40.0 to")
        self.assertEqual(findings["odometry"]["status"], "unknown")
        self.assertEqual(findings["floor"]["status"], "ok")
        result = run("localize", "--map", self.map, "--frames", folder, "--out", self.folder / "out.tum", "--fuse")
        self.assertEqual(result.returncode, 1)
        self.assertIn(findings["clock"]["sentence"], result.stderr)

    def test_dense_poses_come_at_the_rate_of_the_sensors_and_do_not_jump(self):
        out, _, _ = self.fuse("--dense")
        poses = tum(out)
        self.assertGreater(len(poses), 1200)
        steps = [math.dist(a[1:3], b[1:3]) for a, b in zip(poses, poses[1:]) if b[0] - a[0] < 0.05]
        jumps = [step for step in steps if step > 0.03]  # 0.35 m/s: 7 mm between odometry messages
        self.assertLessEqual(len(jumps), KIDNAPS + 1)  # plus one wheel slip

    def test_visual_odometry_replaces_missing_wheel_odometry(self):
        out, results, _ = self.fuse(frames=self.without("odometry.tum", "imu.csv"))
        self.assertEqual(sum(result.get("reanchored", False) for result in results), KIDNAPS)
        self.assertLess(self.rmse_m(out), 1.5e-3)

    def test_simpler_methods_can_be_chosen_to_compare(self):
        # The truth is in the map's frame: pure integration diverges, and the jump filter never recovers.
        ours, _, _ = self.fuse()
        ours = self.rmse_m(ours)
        for method in ("increments", "jump_filter"):
            estimate, _, _ = self.fuse("--fusion-method", method)
            self.assertGreater(self.rmse_m(estimate), 50 * ours, method)
        for method in ("fixes", "replace"):
            estimate, results, _ = self.fuse("--fusion-method", method)
            self.assertTrue(all(result["accepted"] for result in results), method)
            self.assertLess(self.rmse_m(estimate), 2e-3, method)

    def test_gives_the_same_answers_again(self):
        first = self.fuse()[0].read_bytes()
        self.assertEqual(self.fuse()[0].read_bytes(), first)

    def test_an_imu_whose_axes_are_not_the_base_frames_is_refused(self):
        frames = self.without()
        readings = (frames / "imu.csv").read_text().splitlines()
        swapped = [readings[0]] + [",".join([t, wz, wy, wx, az, ay, ax])
                                   for t, wx, wy, wz, ax, ay, az in (row.split(",") for row in readings[1:])]
        (frames / "imu.csv").write_text("\n".join(swapped) + "\n")
        out = self.folder / "fused.tum"
        result = run("localize", "--map", self.map, "--frames", frames, "--out", out, "--fuse")
        self.assertEqual(result.returncode, 1)
        self.assertIn("imu.csv", result.stderr)
        self.assertIn("--no-imu", result.stderr)
        self.assertFalse(out.exists())
        run_ok("localize", "--map", self.map, "--frames", frames, "--out", out, "--fuse", "--no-imu")

    def test_the_truth_is_no_prior_of_a_filter(self):
        result = run("localize", "--map", self.map, "--frames", DRIVE, "--out", self.folder / "fused.tum", "--fuse",
                     "--prior", "truth")
        self.assertEqual(result.returncode, 2)
        self.assertIn("--prior", result.stderr)


if __name__ == "__main__":
    unittest.main()
