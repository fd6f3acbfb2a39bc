# SPDX-License-Identifier: Apache-2.0
"""Visual odometry of the real floorloc-mapbuilder on a simulated drive, scored with evaluate, and its failures."""

import json
import math
import shutil
import unittest

from builder import Scratch, run, run_ok


class Odometry(Scratch):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.drive = cls.root / "drive"
        run_ok("simulate", "--texture", "concrete", "--size", "1.4x1.0", "--trajectory", "drive", "--frames", "40",
               "--fps", "10", "--speed", "0.3", "--odometry-drift", "5", "--out", cls.drive)

    def track(self, *options, drive=None):
        out = self.folder / "est.tum"
        results = self.folder / "results.jsonl"
        summary = run_ok("odometry", "--frames", drive or self.drive, "--out", out, "--results", results, "--json",
                         *options)
        return json.loads(summary), out, [json.loads(line) for line in results.read_text().splitlines()]

    def error(self, out, metric="ape", align="se2"):
        return json.loads(run_ok("evaluate", metric, self.drive / "groundtruth.tum", out, "--align", align, "--json"))

    def length(self):
        rows = [[float(v) for v in line.split()] for line in (self.drive / "groundtruth.tum").read_text().splitlines()]
        return sum(math.dist(a[1:3], b[1:3]) for a, b in zip(rows, rows[1:]))

    def test_planar_follows_the_drive(self):
        summary, out, lines = self.track()
        self.assertEqual((summary["frames"], summary["tracked"], summary["lost"]), (40, 39, 0))
        self.assertEqual(summary["breaks"], 0)
        self.assertAlmostEqual(summary["length_m"], self.length(), delta=0.02 * self.length())
        self.assertLess(self.error(out, "rpe")["translation"]["rmse"], 1e-3)
        self.assertLess(self.error(out)["translation"]["rmse"], 2e-3)
        self.assertEqual(lines[0]["status"], "first_frame")
        self.assertIsNone(lines[0]["motion"])
        motion = lines[-1]["motion"]
        self.assertEqual(motion["from"], lines[-2]["timestamp"])
        self.assertEqual(len(motion["covariance"]), 9)
        self.assertGreaterEqual(motion["inliers"], 12)

    def test_planar_starts_at_the_odometry_and_uses_it_when_asked(self):
        _, out, _ = self.track("--prior", "odometry", "--threads", "2")
        first = out.read_text().splitlines()[0].split()
        wheels = (self.drive / "odometry.tum").read_text().splitlines()[0].split()
        self.assertEqual([float(v) for v in first], [float(v) for v in wheels])
        self.assertLess(self.error(out)["translation"]["rmse"], 2e-3)

    def test_planar_is_the_same_for_any_number_of_threads(self):
        _, out, _ = self.track("--threads", "1")
        one = out.read_bytes()
        _, out, _ = self.track("--threads", "2")
        self.assertEqual(out.read_bytes(), one)

    def test_monocular_needs_no_floor(self):
        drive = self.folder / "drive"
        shutil.copytree(self.drive, drive)
        (drive / "floor.yaml").unlink()
        summary, out, lines = self.track("--mode", "monocular", "--features", "akaze", "--scale-from",
                                         self.drive / "groundtruth.tum", drive=drive)
        self.assertEqual(summary["tracked"] + summary["lost"], 39)
        self.assertGreater(summary["tracked"], 20)
        self.assertGreater(summary["length_m"], 0.1)
        self.assertEqual(len(out.read_text().splitlines()), 40 - summary["lost"])
        self.assertEqual(lines[0]["position"], [0, 0, 0])
        planar = run("odometry", "--frames", drive, "--out", self.folder / "planar.tum")
        self.assertEqual(planar.returncode, 1)
        self.assertIn("floor.yaml", planar.stderr)

    def test_refuses_in_one_sentence(self):
        out = self.folder / "est.tum"
        drive = self.folder / "drive"
        shutil.copytree(self.drive, drive)
        (drive / "odometry.tum").unlink()
        cases = {
            ("--frames", drive, "--prior", "odometry"): "has no odometry.tum",
            ("--frames", self.drive, "--features", "nonsense"): "known",
            ("--frames", self.drive, "--border", "10"): "--mode monocular",
            ("--frames", self.drive, "--mode", "monocular", "--features", "sift"): "orb, brisk, akaze",
            ("--frames", self.folder / "nowhere",): "is not a folder",
        }
        for arguments, expected in cases.items():
            result = run("odometry", *arguments, "--out", out)
            self.assertEqual(result.returncode, 1, arguments)
            self.assertIn(expected, result.stderr)
            self.assertFalse(out.exists())
        self.assertEqual(run("odometry", "--frames", self.drive).returncode, 2)


if __name__ == "__main__":
    unittest.main()
