# SPDX-License-Identifier: Apache-2.0
"""One floor surveyed in two overlapping parts by two robots; made once per test class."""

import json
import math
import shutil

from builder import Scratch, run_ok

FLOOR = ["simulate", "--texture", "concrete", "--size", "1.8x0.9", "--floor-seed", "7"]
TRUE_POSES = ["--poses-sigma", "0.005,0.005", "--poses"]


def read_truth(folder):
    poses = {}
    for line in (folder / "groundtruth.tum").read_text().splitlines():
        if not line.startswith("#"):
            row = [float(value) for value in line.split()]
            poses[round(row[0], 4)] = (row[1], row[2], 2 * math.atan2(row[6], row[7]))
    return poses


def keep_frames(source, target, keep):
    """Copies a survey, keeping the frames whose true pose passes the test."""
    shutil.copytree(source, target)
    truth = read_truth(source)
    head, *rows = (source / "frames.csv").read_text().splitlines()
    kept = [row for row in rows if keep(truth[round(float(row.split(",")[0]), 4)])]
    (target / "frames.csv").write_text("\n".join([head, *kept]) + "\n")
    return len(kept)


class PartialSurveys(Scratch):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        run_ok(*FLOOR, "--out", cls.root / "first", "--seed", "1")
        run_ok(*FLOOR, "--out", cls.root / "second", "--seed", "2")
        run_ok(*FLOOR, "--out", cls.root / "later", "--seed", "3", "--trajectory", "random", "--frames", "24")
        cls.west, cls.east = cls.root / "west", cls.root / "east"
        cls.west_frames = keep_frames(cls.root / "first", cls.west, lambda pose: pose[0] < 0.8)
        cls.east_frames = keep_frames(cls.root / "second", cls.east, lambda pose: pose[0] > 0.68)
        cls.old = cls.root / "old.floormap"
        run_ok("build", "--survey", cls.west, "--out", cls.old, *TRUE_POSES, cls.west / "groundtruth.tum")

    def setUp(self):
        super().setUp()
        self.out = self.folder / "new.floormap"

    def localize(self, floormap, frames):
        results = self.folder / "results.jsonl"
        run_ok("localize", "--map", floormap, "--frames", frames, "--out", self.folder / "e.tum", "--results", results)
        truth = read_truth(frames)
        lines = [json.loads(line) for line in results.read_text().splitlines()]
        for line in lines:
            if line["status"] == "localized":
                self.assertLess(math.dist((line["x"], line["y"]), truth[round(line["timestamp"], 4)][:2]), 3e-3, line)
        return lines
