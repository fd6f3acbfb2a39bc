# SPDX-License-Identifier: Apache-2.0
"""`build --extend` adds a new area and a worn floor to a map in the map's frame."""

import json
import math
import shutil
import sqlite3
import subprocess
import unittest

from builder import BINARY, run, run_ok
from partial_surveys import FLOOR, TRUE_POSES, PartialSurveys, read_truth


class Extended(PartialSurveys):
    def extend(self, survey, *arguments, old=None, out=None):
        return json.loads(run_ok("build", "--survey", survey, "--extend", old or self.old, "--out", out or self.out,
                                 "--json", *arguments))

    def test_a_new_area(self):
        report = self.extend(self.east)
        self.assertEqual(report["frames_used"], self.east_frames)
        self.assertGreaterEqual(report["frames_found"], 5)
        self.assertLess(report["frames_found"], self.east_frames)
        run_ok("verify", self.out)

        info, before = (json.loads(run_ok("info", file, "--json")) for file in (self.out, self.old))
        self.assertEqual(info["id"], before["id"])
        self.assertEqual(before["parents"], [])
        self.assertEqual(info["parents"], [{"relation": "extends", "id": before["id"], "version": before["version"]}])
        self.assertEqual(info["frames"], self.west_frames + self.east_frames)
        self.assertEqual([survey["folder"] for survey in info["surveys"]], ["west", "east"])

        diff = json.loads(run_ok("diff", self.old, self.out, "--json"))
        self.assertEqual(diff["relation"], "extends")
        self.assertEqual(diff["frames"], {"kept": self.west_frames, "removed": 0, "added": self.east_frames})
        self.assertEqual(diff["moves"]["max_m"], 0)
        self.assertLess(diff["area_m2"]["lost"], 1e-3)
        self.assertGreater(diff["area_m2"]["gained"], 0.3)
        self.assertGreater(diff["keypoints"]["kept"], 3 * diff["keypoints"]["gone"])

        with sqlite3.connect(self.out) as database:
            rows = database.execute("SELECT stamp_ns, x, y FROM frame WHERE survey = 1").fetchall()
            old_links = sqlite3.connect(self.old).execute("SELECT COUNT(*) FROM link").fetchone()[0]
            links = database.execute("SELECT COUNT(*), MAX(second) FROM link").fetchone()
        self.assertEqual(links, (old_links + report["links"], self.west_frames + self.east_frames - 1))
        truth = read_truth(self.east)
        errors = [math.dist((x, y), truth[round(stamp / 1e9, 4)][:2]) for stamp, x, y in rows]
        self.assertLess(math.sqrt(sum(e * e for e in errors) / len(errors)), 1.5e-3)

        found = self.localize(self.out, self.root / "later")
        self.assertEqual({line["status"] for line in found}, {"localized"})
        found_before = self.localize(self.old, self.root / "later")
        self.assertLess(sum(line["status"] == "localized" for line in found_before), len(found))

    def test_the_old_file_may_be_replaced_and_the_mosaic_keeps(self):
        out = self.folder / "hall.floormap"
        shutil.copy(self.old, out)
        self.extend(self.east, old=out, out=out)
        run_ok("verify", out)
        with sqlite3.connect(self.old) as old, sqlite3.connect(out) as new:
            zoom = "(SELECT MAX(z) FROM mosaic_tile)"
            before = dict(((x, y), jpeg) for x, y, jpeg in
                          old.execute(f"SELECT x, y, jpeg FROM mosaic_tile WHERE z = {zoom}"))
            after = dict(((x, y), jpeg) for x, y, jpeg in
                         new.execute(f"SELECT x, y, jpeg FROM mosaic_tile WHERE z = {zoom}"))
        self.assertLessEqual(set(before), set(after))
        west = [tile for tile in before if tile[0] < min(x for x, _ in before) + 2]
        self.assertTrue(west)
        for tile in west:
            self.assertEqual(before[tile], after[tile], tile)

    def test_a_worn_floor(self):
        worn = ["--wear", "0.75", "--seed", "9", "--condition", "hard"]
        run_ok(*FLOOR, "--out", self.folder / "worn", *worn[:4])
        run_ok(*FLOOR, "--out", self.folder / "later", *worn, "--trajectory", "random", "--frames", "30")
        whole = self.folder / "whole.floormap"
        run_ok("build", "--survey", self.root / "first", "--out", whole, *TRUE_POSES,
               self.root / "first" / "groundtruth.tum")
        self.extend(self.folder / "worn", old=whole)
        found = {}
        for name, floormap in (("before", whole), ("after", self.out)):
            lines = self.localize(floormap, self.folder / "later")
            found[name] = sum(line["status"] == "localized" for line in lines)
        self.assertGreater(found["after"], found["before"] + 3, found)

    def test_another_floor_is_refused(self):
        other = self.folder / "other"
        run_ok("simulate", "--texture", "concrete", "--size", "1.2x0.9", "--floor-seed", "8", "--out", other)
        result = run("build", "--survey", other, "--extend", self.old, "--out", self.out)
        self.assertEqual(result.returncode, 1)
        self.assertIn("does not overlap the map", result.stderr)
        self.assertFalse(self.out.exists())

    def test_the_features_are_those_of_the_map(self):
        for option in (["--features", "orb"], ["--max-keypoints", "300"], ["--resolution", "0.002"]):
            result = run("build", "--survey", self.east, "--extend", self.old, "--out", self.out, *option)
            self.assertEqual(result.returncode, 2, option)
        self.assertEqual(run("build", "--survey", self.east, "--extend", self.folder / "none.floormap", "--out",
                             self.out).returncode, 1)

    def test_a_killed_extension_is_resumed(self):
        whole = self.extend(self.east)
        self.out.unlink()
        command = [BINARY, "build", "--survey", self.east, "--extend", self.old, "--out", self.out, "--json"]
        with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as build:
            while not build.stderr.readline().startswith("mosaic"):
                self.assertIsNone(build.poll())
            build.kill()
            build.stderr.close()
        self.assertFalse(self.out.exists())
        report = self.extend(self.east, "--resume")
        self.assertEqual(report["resumed_frames"], self.east_frames)
        self.assertEqual(report["frames_found"], whole["frames_found"])
        self.assertEqual(report["content_version"], whole["content_version"])


if __name__ == "__main__":
    unittest.main(verbosity=2)
