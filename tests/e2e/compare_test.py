# SPDX-License-Identifier: Apache-2.0
"""The feature laboratory of the real floorloc-mapbuilder: table, JSON, page, the thesis's tests, and bad input."""

import functools
import json
import shutil
import unittest
from html.parser import HTMLParser

import builder

NUMBERS = {
    "map_keypoints", "frame_keypoints", "repeatability_percent", "matches", "right_percent", "inliers",
    "localized_percent", "success_percent", "position_mean_mm", "position_median_mm", "heading_mean_deg",
    "heading_median_deg", "precision_mm", "precision_deg", "detect_ms", "describe_ms", "match_ms", "register_ms",
    "total_ms",
}
WORDS = {"detector", "descriptor", "matcher", "filter", "not_possible"}

# Dozens of combinations need more than the default timeout.
run = functools.partial(builder.run, timeout=300)
run_ok = functools.partial(builder.run_ok, timeout=300)


class Page(HTMLParser):
    """Counts elements, and collects the resources that a browser would load."""

    def __init__(self, text):
        super().__init__()
        self.count = {}
        self.loads = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.count[tag] = self.count.get(tag, 0) + 1
        self.loads += [value for name, value in attrs if name in ("src", "href")]


class Compare(builder.Scratch):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.survey = cls.root / "survey"
        cls.drive = cls.root / "drive"
        floor = ["simulate", "--texture", "concrete", "--size", "1.0x0.8", "--floor-seed", "5"]
        run_ok(*floor, "--out", cls.survey, "--seed", "1")
        run_ok(*floor, "--out", cls.drive, "--seed", "2", "--trajectory", "drive", "--frames", "6", "--fps", "4")

    def compare(self, *arguments, survey=None):
        return ["compare", "--survey", survey or self.survey, "--frames", self.drive, *arguments]

    def rows(self, *arguments, survey=None):
        return json.loads(run_ok(*self.compare("--json", *arguments, survey=survey)))["tables"][0]["rows"]

    def test_compares_in_json(self):
        rows = self.rows("--detectors", "orb,sift", "--descriptors", "orb,akaze", "--matchers", "all", "--filters",
                         "ratio,ratio+ransac,ratio+ransac+jump")
        by_name = {(row["detector"], row["descriptor"], row["matcher"], row["filter"]): row for row in rows}
        for row in rows:
            self.assertEqual(set(row), NUMBERS | WORDS)
        for detector in ("orb", "sift"):
            for matcher in ("brute-force", "flann"):
                for filters in ("ratio", "ratio+ransac", "ratio+ransac+jump"):
                    self.assertIn((detector, "orb", matcher, filters), by_name)
            impossible = by_name[detector, "akaze", None, None]
            self.assertIn("AKAZE", impossible["not_possible"])
            self.assertIsNone(impossible["success_percent"])
        best = by_name["orb", "orb", "brute-force", "ratio+ransac"]
        self.assertEqual(best["success_percent"], 100)
        self.assertLess(best["position_median_mm"], 3)
        self.assertLess(best["precision_mm"], 3)
        self.assertGreater(best["map_keypoints"], best["frame_keypoints"])
        self.assertGreaterEqual(best["matches"], best["inliers"])
        stages = sum(best[key] for key in ("detect_ms", "describe_ms", "match_ms", "register_ms"))
        self.assertAlmostEqual(stages, best["total_ms"], places=6)
        self.assertEqual(by_name["orb", "orb", "brute-force", "ratio+ransac+jump"]["success_percent"], 100)
        self.assertIn(("contour", "hu", "flann", "ratio"), by_name)
        template = by_name["template", None, None, None]
        self.assertIsNone(template["matches"])
        self.assertGreater(template["match_ms"], 0)

    def test_tolerance_decides_what_a_success_is(self):
        lists = ["--detectors", "orb", "--descriptors", "orb", "--matchers", "flann", "--filters", "ratio+ransac",
                 "--methods", "features"]
        (strict,) = self.rows(*lists, "--tolerance-mm", "0.0001")
        self.assertEqual(strict["success_percent"], 0)
        self.assertEqual(strict["localized_percent"], 100)

    def test_prints_a_table_and_writes_a_page(self):
        page = self.folder / "report.html"
        text = run_ok(*self.compare("--detectors", "orb,fast", "--descriptors", "orb", "--filters", "ratio+ransac",
                                    "--methods", "features", "--max-frames", "3", "--report", page))
        self.assertIn("3 in 1 folder", text)
        lines = [line for line in text.splitlines() if line.startswith(("orb ", "fast "))]
        self.assertEqual(len(lines), 4)
        html = Page(page.read_text())
        self.assertEqual(html.count["svg"], 3)
        self.assertEqual(html.count["tr"], 5)
        self.assertEqual(html.loads, [])
        self.assertGreaterEqual(html.count["circle"], 4)

    def test_thesis_tests_have_their_columns(self):
        (orb,) = self.rows("--test", "1", "--detectors", "orb")
        self.assertEqual(orb["detector"], "orb")
        self.assertGreater(orb["features"], 100)
        rows = self.rows("--test", "2", "--detectors", "orb,sift", "--descriptors", "orb,sift,akaze")
        self.assertEqual([(row["matcher"], row["detector"]) for row in rows],
                         [("brute-force", "orb"), ("brute-force", "sift"), ("flann", "orb"), ("flann", "sift")])
        self.assertGreater(rows[0]["orb"], 20)
        self.assertEqual(rows[0]["akaze"], "not possible")
        rows = self.rows("--test", "3", "--detectors", "sift", "--descriptors", "sift,brisk")
        self.assertEqual([row["extractor"] for row in rows], ["sift", "brisk"])
        self.assertGreater(rows[0]["optimal_ratio"], 0.5)
        self.assertGreater(rows[0]["right"], rows[0]["wrong"])
        rows = self.rows("--test", "4", "--detectors", "sift", "--descriptors", "sift", "--matchers", "flann")
        self.assertEqual([row["filter"] for row in rows],
                         ["ratio", "ratio+ransac", "ratio+ransac+jump", "ratio+jump"])
        self.assertEqual({row["bag"] for row in rows}, {"drive"})
        self.assertEqual({row["processed_images"] for row in rows}, {6})
        self.assertEqual(rows[1]["correct"], 6)
        self.assertGreaterEqual(rows[0]["calculated"], rows[3]["not_filtered"])

    def test_a_survey_without_truth_is_placed_by_the_builder(self):
        survey = self.folder / "survey"
        shutil.copytree(self.survey, survey)
        (survey / "groundtruth.tum").unlink()
        (row,) = self.rows("--detectors", "orb", "--descriptors", "orb", "--matchers", "flann", "--filters",
                           "ratio+ransac", "--methods", "features", survey=survey)
        self.assertEqual(row["success_percent"], 100)

    def expect_failure(self, code, part, *arguments):
        result = run("compare", *arguments)
        self.assertEqual(result.returncode, code, result.stderr)
        self.assertIn(part, result.stderr)
        self.assertEqual(result.stdout, "")
        return result.stderr

    def test_bad_input_is_one_sentence(self):
        frames = self.folder / "frames"
        shutil.copytree(self.drive, frames)
        (frames / "groundtruth.tum").unlink()
        both = ["--survey", self.survey, "--frames"]
        sentence = self.expect_failure(1, "groundtruth.tum", *both, frames)
        self.assertEqual(len(sentence.strip().splitlines()), 1)
        self.expect_failure(1, "missing", *both, self.folder / "missing")
        self.expect_failure(1, "missing", "--survey", self.folder / "missing", "--frames", self.drive)
        self.expect_failure(1, "r.html", *both, self.drive, "--report", self.folder / "no" / "r.html")
        self.expect_failure(1, "keypoints", *both, self.drive, "--keypoints", "-1")
        self.expect_failure(2, "unknown detector 'orbb'", *both, self.drive, "--detectors", "orb,orbb")
        self.expect_failure(2, "--test", *both, self.drive, "--test", "5")
        self.expect_failure(2, "--frames", "--survey", self.survey)


if __name__ == "__main__":
    unittest.main(verbosity=2)
