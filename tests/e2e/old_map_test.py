# SPDX-License-Identifier: Apache-2.0
"""The real binary uses, extends and merges a map of format version 2, written before layers existed."""

import json
import math
import shutil
import sqlite3
import unittest
from pathlib import Path

from builder import Scratch, run, run_ok

DATA = Path(__file__).parents[1] / "core" / "map" / "data"
VERSION = "2c79d754869b150b1b27b3c48bd8ce15469004df6ad28cfe71e38f4c6b2ee166"
# True pose (x, y, yaw) of version_2_frame.jpg.
TRUTH = (0.279529251, 0.108079039, 2 * math.atan2(0.614691882905, 0.788767322530))


def info(file):
    return json.loads(run_ok("info", file, "--json"))


def change(file, sql):
    with sqlite3.connect(file) as connection:
        connection.executescript(sql)
    connection.close()


class BaseMap(Scratch):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.survey = cls.root / "survey"
        run_ok("simulate", "--texture", "concrete", "--size", "0.8x0.6", "--floor-seed", "5", "--out", cls.survey)

    def setUp(self):
        super().setUp()
        self.map = self.folder / "old.floormap"
        shutil.copy(DATA / "version_2.floormap", self.map)

    def test_it_is_whole(self):
        self.assertIn(VERSION, run_ok("verify", self.map))
        self.assertEqual(info(self.map)["format_version"], 2)

    def test_it_localizes(self):
        frames = self.folder / "frames"
        (frames / "images").mkdir(parents=True)
        shutil.copy(DATA / "version_2_frame.jpg", frames / "images" / "000000.jpg")
        (frames / "frames.csv").write_text("timestamp,filename\n1700000000.0,images/000000.jpg\n")
        run_ok("export", self.map, "--camera", frames)
        results = self.folder / "results.jsonl"
        run_ok("localize", "--map", self.map, "--frames", frames, "--out", self.folder / "est.tum", "--results", results)
        result = json.loads(results.read_text())
        self.assertEqual(result["status"], "localized")
        self.assertLess(math.hypot(result["x"] - TRUTH[0], result["y"] - TRUTH[1]), 0.003)
        self.assertLess(abs(result["yaw"] - TRUTH[2]), 0.01)

    def test_it_is_extended_to_a_map_of_today(self):
        out = self.folder / "new.floormap"
        report = json.loads(run_ok("build", "--survey", self.survey, "--extend", self.map, "--out", out, "--json"))
        self.assertFalse([w for w in report["warnings"] if "layer" in w])
        run_ok("verify", out)
        new = info(out)
        self.assertEqual(new["format_version"], 3)
        self.assertEqual([layer["name"] for layer in new["layers"]], ["calibration", "floor_texture", "frames", "keypoints", "mosaic"])
        self.assertEqual(new["parents"][0]["version"], VERSION)
        self.assertEqual(json.loads(run_ok("diff", self.map, out, "--json"))["relation"], "extends")

    def test_layers_of_a_newer_version_are_not_lost_in_silence(self):
        today = self.folder / "today.floormap"
        run_ok("merge", self.map, self.map, "--same-frame", "--out", today)
        layer = "CREATE TABLE zones (x REAL); INSERT INTO layer VALUES ('zones', 1, {}, '" + 64 * "a" + "')"
        optional = self.folder / "optional.floormap"
        shutil.copy(today, optional)
        change(optional, layer.format(0))
        self.assertIn("zones", run_ok("info", optional))
        out = self.folder / "out.floormap"
        merged = json.loads(run_ok("merge", optional, self.map, "--same-frame", "--out", out, "--json"))
        self.assertEqual(len(merged["warnings"]), 1)
        self.assertIn("the layer 'zones' of optional.floormap is not in the new map", merged["warnings"][0])
        self.assertNotIn("zones", run_ok("info", out))
        built = json.loads(run_ok("build", "--survey", self.survey, "--extend", optional, "--out", out, "--json"))
        self.assertTrue([w for w in built["warnings"] if "the layer 'zones' of optional.floormap" in w])
        required = self.folder / "required.floormap"
        shutil.copy(today, required)
        change(required, layer.format(1))
        for command in (["info", required], ["verify", required], ["merge", required, self.map, "--out", out]):
            refused = run(*command)
            self.assertEqual(refused.returncode, 1, command)
            self.assertIn("has the layer 'zones' in version 1", refused.stderr)
            self.assertIn("use a newer version of floorloc", refused.stderr)


class Damaged(Scratch):
    """Exit codes and the sentence on stderr, which tests within one process cannot check after a crash."""

    def test_every_command_says_what_is_wrong(self):
        whole, damaged = DATA / "version_2.floormap", self.folder / "damaged.floormap"
        out, report = self.folder / "out.floormap", self.folder / "report"
        commands = [["info", damaged], ["verify", damaged], ["diff", damaged, whole], ["diff", whole, damaged],
                    ["report", damaged, "--out", report], ["merge", whole, damaged, "--same-frame", "--out", out],
                    ["export", damaged, "--g2o", self.folder / "graph.g2o"]]
        for sql, what in (("UPDATE frame SET survey = 1000000", "frame 0: survey is 1000000"),
                          ("UPDATE link SET first = -7 WHERE first = (SELECT min(first) FROM link) AND second ="
                           " (SELECT min(second) FROM link WHERE first = (SELECT min(first) FROM link))", "link 0: first is -7"),
                          ("UPDATE frame SET x = 1e300 WHERE id = 3", "frame 3: x is 1e+300")):
            shutil.copy(whole, damaged)
            change(damaged, "PRAGMA ignore_check_constraints = ON; " + sql)
            for command in commands:
                result = run(*command)
                self.assertEqual(result.returncode, 1, (sql, command, result.stderr))
                lines = result.stderr.splitlines()
                self.assertEqual(len(lines), 1, lines)
                self.assertIn(what, lines[0])
                self.assertIn("restore it from a copy or build it again", lines[0])


if __name__ == "__main__":
    unittest.main(verbosity=2)
