# SPDX-License-Identifier: Apache-2.0
"""Output of `diff` for two maps."""

import json
import re
import shutil
import unittest

from builder import Scratch, run, run_ok


class Diff(Scratch):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.survey = cls.root / "survey"
        cls.whole = cls.root / "whole.floormap"
        run_ok("simulate", "--texture", "concrete", "--size", "1.2x0.9", "--floor-seed", "5", "--out", cls.survey)
        run_ok("build", "--survey", cls.survey, "--out", cls.whole)
        half = cls.root / "half" / "survey"
        shutil.copytree(cls.survey, half)
        lines = (half / "frames.csv").read_text().splitlines()
        (half / "frames.csv").write_text("\n".join(lines[:15]) + "\n")
        cls.half = cls.root / "half.floormap"
        run_ok("build", "--survey", half, "--out", cls.half)

    def diff(self, before, after):
        return json.loads(run_ok("diff", before, after, "--json"))

    def test_a_map_equals_itself(self):
        diff = self.diff(self.whole, self.whole)
        self.assertEqual(diff["relation"], "same content")
        self.assertEqual((diff["area_m2"]["gained"], diff["area_m2"]["lost"]), (0, 0))
        self.assertEqual(diff["frames"], {"kept": 28, "removed": 0, "added": 0})
        self.assertEqual(diff["moves"]["max_m"], 0)
        self.assertEqual((diff["keypoints"]["gone"], diff["keypoints"]["added"]), (0, 0))
        self.assertGreater(diff["keypoints"]["kept"], 2000)
        self.assertEqual(diff["parameters"], [])
        self.assertIn("same content", run_ok("diff", self.whole, self.whole))

    def test_what_half_a_survey_lacks(self):
        diff = self.diff(self.half, self.whole)
        self.assertEqual(diff["relation"], "another map")
        self.assertEqual(diff["frames"], {"kept": 14, "removed": 0, "added": 14})
        area = diff["area_m2"]
        self.assertAlmostEqual(area["gained"], area["after"] - area["before"], delta=0.1 * area["after"])
        self.assertGreater(area["gained"], 0.2)
        self.assertLess(area["lost"], 0.01)
        self.assertLess(diff["moves"]["rms_m"], 2e-3)
        self.assertGreater(diff["moves"]["max_m"], 0)
        self.assertTrue(diff["moves"]["farthest"].startswith("images/"))
        self.assertGreater(diff["keypoints"]["kept"], 4 * diff["keypoints"]["gone"])
        self.assertGreater(diff["keypoints"]["added"], 500)
        back = self.diff(self.whole, self.half)
        self.assertEqual(back["frames"], {"kept": 14, "removed": 14, "added": 0})
        self.assertEqual(back["area_m2"]["lost"], area["gained"])
        self.assertAlmostEqual(back["keypoints"]["kept"], diff["keypoints"]["kept"], delta=20)

    def test_other_parameters_are_named(self):
        survey = self.root / "other" / "survey"
        shutil.copytree(self.survey, survey)
        camera = survey / "camera.yaml"
        camera.write_text(re.sub(r"data: \[([\d.]+),", lambda m: f"data: [{float(m[1]) * 1.0001:.9g},",
                                 camera.read_text(), count=1))
        other = self.root / "other.floormap"
        run_ok("build", "--survey", survey, "--out", other, "--features", "orb")
        diff = self.diff(self.whole, other)
        self.assertIsNone(diff["keypoints"])
        named = {row["name"]: (row["before"], row["after"]) for row in diff["parameters"]}
        self.assertEqual(named["extractor type"], ("hessian", "orb"))
        self.assertIn("camera of survey: fx", named)
        self.assertIn("another extractor", run_ok("diff", self.whole, other))

    def test_no_map_is_one_sentence(self):
        result = run("diff", self.whole, self.survey / "camera.yaml")
        self.assertEqual(result.returncode, 1)
        self.assertIn("camera.yaml", result.stderr)
        self.assertEqual(run("diff", self.whole).returncode, 2)


if __name__ == "__main__":
    unittest.main(verbosity=2)
