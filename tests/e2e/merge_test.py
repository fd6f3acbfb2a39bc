# SPDX-License-Identifier: Apache-2.0
"""`merge` of two maps that overlap or share a frame."""

import json
import math
import sqlite3
import unittest

from builder import run, run_ok
from partial_surveys import FLOOR, TRUE_POSES, PartialSurveys, read_truth


class Merged(PartialSurveys):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        # The second map's frame is that of its own odometry.
        cls.second = cls.root / "second.floormap"
        run_ok("build", "--survey", cls.east, "--out", cls.second)

    def merge(self, first, second, *arguments):
        return json.loads(run_ok("merge", first, second, "--out", self.out, "--json", *arguments))

    def test_maps_that_overlap(self):
        report = self.merge(self.old, self.second)
        run_ok("verify", self.out)
        self.assertEqual(report["frames"], self.west_frames + self.east_frames)
        self.assertGreaterEqual(report["shared_frames"], 5)
        self.assertGreater(report["shared_keypoints"], 500)
        info, a, b = (json.loads(run_ok("info", file, "--json")) for file in (self.out, self.old, self.second))
        self.assertEqual(info["id"], a["id"])
        self.assertEqual([(parent["relation"], parent["version"]) for parent in info["parents"]],
                         [("merges", a["version"]), ("merges", b["version"])])
        self.assertEqual([survey["folder"] for survey in info["surveys"]], ["west", "east"])
        self.assertLess(info["area_m2"], a["area_m2"] + b["area_m2"] - 0.1)
        diff = json.loads(run_ok("diff", self.old, self.out, "--json"))
        self.assertEqual(diff["relation"], "merges")
        self.assertEqual(diff["moves"]["max_m"], 0)

        with sqlite3.connect(self.out) as database:
            rows = database.execute("SELECT stamp_ns, x, y FROM frame WHERE survey = 1").fetchall()
        truth = read_truth(self.east)
        errors = [math.dist((x, y), truth[round(stamp / 1e9, 4)][:2]) for stamp, x, y in rows]
        self.assertLess(math.sqrt(sum(e * e for e in errors) / len(errors)), 2e-3)
        lines = self.localize(self.out, self.root / "later")
        self.assertEqual({line["status"] for line in lines}, {"localized"})

    def test_maps_of_one_frame_need_not_overlap(self):
        far = self.folder / "far"
        run_ok(*FLOOR[:-1], "8", "--out", far, "--seed", "4")
        poses = self.folder / "far.tum"
        rows = [line.split() for line in (far / "groundtruth.tum").read_text().splitlines() if line[0] != "#"]
        poses.write_text("".join(" ".join([row[0], str(float(row[1]) + 5.0), *row[2:]]) + "\n" for row in rows))
        other = self.folder / "far.floormap"
        run_ok("build", "--survey", far, "--out", other, *TRUE_POSES, poses)
        result = run("merge", self.old, other, "--out", self.out)
        self.assertEqual(result.returncode, 1)
        self.assertIn("--same-frame", result.stderr)
        self.assertFalse(self.out.exists())
        report = self.merge(self.old, other, "--same-frame")
        self.assertEqual(report["shared_frames"], 0)
        self.assertEqual(report["bent_m"], 0)
        extent = json.loads(run_ok("info", self.out, "--json"))["extent"]
        self.assertGreater(extent["x_max"], 6.5)
        run_ok("verify", self.out)

    def test_other_features_are_refused(self):
        other = self.folder / "orb.floormap"
        run_ok("build", "--survey", self.east, "--out", other, "--features", "orb")
        result = run("merge", self.old, other, "--out", self.out)
        self.assertEqual(result.returncode, 1)
        self.assertIn("another feature extractor", result.stderr)
        self.assertEqual(len(result.stderr.strip().splitlines()), 1)


if __name__ == "__main__":
    unittest.main(verbosity=2)
