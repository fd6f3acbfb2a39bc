# SPDX-License-Identifier: Apache-2.0
"""Evaluation of features for visual odometry by the real floorloc-mapbuilder, on images of maps/."""

import functools
import json
import pathlib
import unittest

import builder

MAPS = pathlib.Path(__file__).resolve().parents[2] / "maps"
SEQUENCE = MAPS / "sample" / "survey"
CONDITIONS = ("shadow", "fog", "brightness", "rotation")

run = functools.partial(builder.run, timeout=300)


class EvaluateFeatures(builder.Scratch):
    def evaluate(self, *arguments):
        result = run("evaluate-features", "--json", *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        report = json.loads(result.stdout)
        return {table["title"].split(":")[0]: table["rows"] for table in report["tables"]}, report["conditions"]

    def test_all_tables(self):
        out = self.folder / "out"
        tables, conditions = self.evaluate(
            "--images", f"texture={MAPS / 'textures'}", f"floor={SEQUENCE}", "--pictures", "2", "--sequence", SEQUENCE,
            "--following", "3", "--counts", "50,250", "--features", "orb,akaze", "--count", "200", "--out", out)
        self.assertEqual(conditions[:2], ["texture: 1 images", "floor: 2 images"])
        names = ["orb", "akaze"]
        self.assertEqual([row["feature"] for row in tables["Table 1"]], names)
        for row in tables["Table 1"]:
            self.assertGreater(row["floor_ms"], 0)
            self.assertAlmostEqual(row["floor_features"], 200, delta=10)
        for name in ("Table 2", "Table 3"):
            self.assertEqual([row["feature"] for row in tables[name]], names)
            for row in tables[name]:
                for condition in CONDITIONS:
                    matched, right = row[f"{condition}_percent"], row[f"{condition}_right_percent"]
                    self.assertTrue(0 <= right <= matched <= 100.0001, (name, row))
                self.assertGreater(row["rotation_right_percent"], 70)
                self.assertGreater(row["rotation_right_percent"], row["fog_right_percent"])
        self.assertEqual([(row["feature"], row["wanted"]) for row in tables["Table 4"]],
                         [("orb", 50), ("orb", 250), ("akaze", 50), ("akaze", 250)])
        for row in tables["Table 4"]:
            self.assertAlmostEqual(row["features"], row["wanted"], delta=0.1 * row["wanted"])
            self.assertIn(" = ", row["setting"])
        for row in tables["Table 5"]:
            self.assertEqual(row["samples"], 6)
            self.assertTrue(-1 <= row["r"] <= 1 and 0 <= row["p"] <= 1, row)
        self.assertIn("Table 4", (out / "index.html").read_text())
        self.assertEqual(len(json.loads((out / "tables.json").read_text())["tables"]), 5)
        for condition in CONDITIONS:
            self.assertEqual((out / f"floor-{condition}-orb.jpg").read_bytes()[:2], b"\xff\xd8")

    def test_paths_of_a_drive(self):
        drive, out = self.folder / "drive", self.folder / "out"
        builder.run_ok("simulate", "--texture", "concrete", "--size", "1.0x0.8", "--trajectory", "drive", "--frames",
                       "25", "--out", drive)
        tables, _ = self.evaluate("--drive", drive, "--features", "orb,sift", "--out", out)
        rows = {row["method"]: row for row in tables["Table 6"]}
        self.assertEqual(list(rows), ["orb", "WO", "IMU+WO"], "SIFT is none of monocular odometry's features")
        wheels = json.loads(builder.run_ok("evaluate", "ape", drive / "groundtruth.tum", drive / "odometry.tum",
                                           "--align", "se2", "--max-diff", "0.02", "--json"))
        for name in ("max", "min", "mean", "std", "rmse"):
            self.assertAlmostEqual(rows["WO"][f"{name}_m"], wheels["translation"][name], places=12)
        self.assertEqual(rows["IMU+WO"]["poses"], 25)
        self.assertLess(rows["IMU+WO"]["rmse_m"], 0.02)
        self.assertNotEqual(rows["IMU+WO"]["rmse_m"], rows["WO"]["rmse_m"])
        self.assertTrue(rows["orb"]["not_possible"] or rows["orb"]["poses"] + rows["orb"]["lost_frames"] == 25)
        self.assertEqual((out / "drive-IMU+WO.png").read_bytes()[:4], b"\x89PNG")
        (drive / "imu.csv").unlink()
        tables, _ = self.evaluate("--drive", drive, "--features", "sift")
        self.assertEqual([row["method"] for row in tables["Table 6"]], ["WO"])
        (drive / "groundtruth.tum").unlink()
        self.expect_failure(1, "has no groundtruth.tum", "--drive", drive)

    def test_the_same_seed_gives_the_same(self):
        arguments = ["--images", f"floor={SEQUENCE}", "--pictures", "1", "--features", "orb"]
        first, conditions = self.evaluate(*arguments)
        self.assertEqual(first["Table 2"], self.evaluate(*arguments)[0]["Table 2"])
        self.assertNotEqual(first["Table 2"], self.evaluate(*arguments, "--seed", "2")[0]["Table 2"])
        self.assertEqual(list(first), ["Table 1", "Table 2"])
        self.assertTrue(any("table 3 is left out" in line for line in conditions))
        self.assertTrue(any("--sequence" in line for line in conditions))

    def expect_failure(self, code, part, *arguments):
        result = run("evaluate-features", *arguments)
        self.assertEqual((result.returncode, result.stdout), (code, ""), result.stderr)
        self.assertIn(part, result.stderr)
        if code == 1:
            self.assertEqual(len(result.stderr.strip().splitlines()), 1, result.stderr)

    def test_bad_input_is_one_sentence(self):
        empty = self.folder / "empty"
        empty.mkdir()
        broken = self.folder / "broken.png"
        broken.write_bytes(b"not an image")
        self.expect_failure(1, "NAME=FOLDER", "--images", "textures")
        self.expect_failure(1, "missing", "--images", f"a={self.folder / 'missing'}")
        self.expect_failure(1, "has no images", "--images", f"a={empty}")
        self.expect_failure(1, "broken.png", "--images", f"a={broken}")
        self.expect_failure(1, "fewer than two", "--sequence", MAPS / "textures")
        self.expect_failure(1, "does not both", "--sequence", SEQUENCE, "--features", "fast")
        self.expect_failure(1, "unknown detector", "--sequence", SEQUENCE, "--features", "orbb")
        self.expect_failure(1, "number of features", "--sequence", SEQUENCE, "--counts", "0")
        self.expect_failure(2, "--pictures", "--images", f"a={empty}", "--pictures", "0")


if __name__ == "__main__":
    unittest.main(verbosity=2)
