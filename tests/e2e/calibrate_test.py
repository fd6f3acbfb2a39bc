# SPDX-License-Identifier: Apache-2.0
"""`calibrate` of the real floorloc-mapbuilder, from images of a board to camera.yaml and floor.yaml, and its failures.
Usage: calibrate_test.py MAPBUILDER BOARD_IMAGES"""

import json
import math
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import yaml

BOARD_IMAGES = sys.argv.pop(2)

from builder import Scratch, run, run_ok  # noqa: E402  (builder takes its argument from sys.argv too)

CHESSBOARD = ["--board", "9x6", "--square", "0.02"]
CHARUCO = ["--board", "9x6", "--square", "0.025", "--charuco", "DICT_4X4_50", "--marker", "0.018"]


def floor_point(floor_yaml, u, v):
    h = yaml.safe_load(floor_yaml.read_text())["homography"]
    x, y, w = (h[3 * row] * u + h[3 * row + 1] * v + h[3 * row + 2] for row in range(3))
    return x / w, y / w


class Calibrate(Scratch):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        for kind in ("chessboard", "charuco", "flat"):
            (cls.root / kind).mkdir()
            subprocess.run([BOARD_IMAGES, cls.root / kind, kind], check=True, timeout=120)

    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="floorloc-e2e-")
        self.addCleanup(temporary.cleanup)
        self.out = Path(temporary.name) / "calibrated"

    def floor_options(self, kind):
        folder = self.root / kind
        return ["--floor-image", folder / "floor.jpg", "--board-pose", (folder / "board_pose.txt").read_text()]

    def assert_refused(self, *arguments, code=1, says):
        result = run("calibrate", "--out", self.out, *arguments)
        self.assertEqual(result.returncode, code, result.stderr)
        self.assertRegex(result.stderr, says)
        self.assertFalse((self.out / "camera.yaml").exists())
        if code == 1:
            sentence = [line for line in result.stderr.splitlines() if not line.startswith("boards:")]
            self.assertEqual(len(sentence), 1, result.stderr)

    def assert_like_truth(self, kind, report):
        truth = yaml.safe_load((self.root / kind / "camera.yaml").read_text())["camera_matrix"]["data"]
        found = yaml.safe_load((self.out / "camera.yaml").read_text())["camera_matrix"]["data"]
        for index in (0, 4, 2, 5):
            self.assertAlmostEqual(found[index], truth[index], delta=1.5)
        self.assertLess(report["rms_px"], 0.2)
        sigma = yaml.safe_load((self.out / "camera.yaml").read_text())["calibration_sigma"]
        self.assertAlmostEqual(report["camera"]["calibration_sigma"], sigma)
        self.assertTrue(report["rms_px"] / math.sqrt(2) <= sigma < 1, sigma)
        for u, v in ((100, 60), (240, 180), (400, 300), (100, 300)):
            expected = floor_point(self.root / kind / "floor.yaml", u, v)
            self.assertLess(math.dist(expected, floor_point(self.out / "floor.yaml", u, v)), 0.002)

    def test_chessboard_gives_camera_and_floor(self):
        report = json.loads(run_ok("calibrate", "--images", self.root / "chessboard", *CHESSBOARD,
                                   *self.floor_options("chessboard"), "--out", self.out, "--json"))
        self.assert_like_truth("chessboard", report)
        self.assertEqual(json.loads((self.out / "calibration.json").read_text()), report)
        self.assertEqual(len(report["pictures"]), 13)
        self.assertEqual(report["pictures_used"], 13)
        self.assertLess(report["floor"]["pictures"][0]["rms_m"], 2e-4)
        self.assertAlmostEqual(report["floor"]["camera_position_m"][2], 0.4, delta=0.002)
        self.assertAlmostEqual(report["floor"]["pitch_down_deg"], 60, delta=0.2)
        self.assertEqual((self.out / "floor_grid.jpg").read_bytes()[:2], b"\xff\xd8")

    def test_the_rest_of_the_product_reads_the_files(self):
        run_ok("calibrate", "--images", self.root / "chessboard", *CHESSBOARD, *self.floor_options("chessboard"),
               "--out", self.out)
        run_ok("simulate", "--texture", "concrete", "--size", "1.2x0.9", "--trajectory", "random", "--frames", "2",
               "--camera-yaml", self.out / "camera.yaml", "--floor-yaml", self.out / "floor.yaml",
               "--out", self.out / "survey")

    def test_charuco_gives_camera_and_floor(self):
        report = json.loads(run_ok("calibrate", "--images", self.root / "charuco", *CHARUCO,
                                   *self.floor_options("charuco"), "--out", self.out, "--json"))
        self.assert_like_truth("charuco", report)

    def test_a_camera_that_is_calibrated_needs_one_image_of_the_floor(self):
        for kind, board in (("chessboard", CHESSBOARD), ("charuco", CHARUCO)):
            camera = self.root / kind / "camera.yaml"
            said = run_ok("calibrate", "--camera", camera, *board, *self.floor_options(kind), "--out", self.out)
            self.assertIn("images: 1 used", said)
            self.assertNotIn("calibration good to", said)
            self.assertEqual(yaml.safe_load((self.out / "camera.yaml").read_text()), yaml.safe_load(camera.read_text()))
            for u, v in ((100, 60), (240, 180), (400, 300), (100, 300)):
                expected = floor_point(self.root / kind / "floor.yaml", u, v)
                self.assertLess(math.dist(expected, floor_point(self.out / "floor.yaml", u, v)), 0.001)
            self.assertEqual((self.out / "floor_grid.jpg").read_bytes()[:2], b"\xff\xd8")

    def test_a_camera_that_is_another_ones_is_noticed(self):
        folder = self.out.parent
        wrong = yaml.safe_load((self.root / "chessboard" / "camera.yaml").read_text())
        wrong["camera_matrix"]["data"][0] *= 1.1
        (folder / "wrong.yaml").write_text(yaml.safe_dump(wrong))
        result = run("calibrate", "--camera", folder / "wrong.yaml", *CHESSBOARD, *self.floor_options("chessboard"),
                     "--out", self.out)
        self.assertRegex(result.stderr, "warning: the board's corners are [0-9.]+ px away")
        wrong["image_width"] += 2
        (folder / "wrong.yaml").write_text(yaml.safe_dump(wrong))
        shutil.rmtree(self.out)
        self.assert_refused("--camera", folder / "wrong.yaml", *CHESSBOARD, *self.floor_options("chessboard"),
                            says="but the camera of --camera has")
        self.assert_refused("--camera", self.root / "chessboard" / "camera.yaml", *CHESSBOARD,
                            says="with --camera only the floor is calibrated")
        self.assert_refused(*CHESSBOARD, code=2, says="--images")

    def test_without_floor_image_there_is_only_a_camera(self):
        said = run_ok("calibrate", "--images", self.root / "chessboard", *CHESSBOARD, "--out", self.out)
        self.assertIn("floor.yaml is not written", said)
        self.assertTrue((self.out / "camera.yaml").exists())
        self.assertFalse((self.out / "floor.yaml").exists())

    def test_roi_and_resolution_can_be_given(self):
        run_ok("calibrate", "--images", self.root / "chessboard", *CHESSBOARD, *self.floor_options("chessboard"),
               "--roi", "0.3,0.45,-0.1,0.1", "--resolution", "0.0011", "--out", self.out)
        floor = yaml.safe_load((self.out / "floor.yaml").read_text())
        self.assertEqual(floor["roi"], {"x_min": 0.3, "x_max": 0.45, "y_min": -0.1, "y_max": 0.1})
        self.assertEqual(floor["resolution"], 0.0011)

    def test_bad_images_are_left_out_and_named(self):
        folder = self.out.parent / "mixed"
        shutil.copytree(self.root / "chessboard", folder)
        (folder / "torn.jpg").write_bytes((folder / "100.jpg").read_bytes()[:3000])
        (folder / "text.jpg").write_text("no image")
        shutil.copy(self.root / "charuco" / "104.jpg", folder / "other.jpg")
        said = run_ok("calibrate", "--images", folder, *CHESSBOARD, "--out", self.out)
        self.assertRegex(said, "left out: torn.jpg: cannot be decoded")
        self.assertRegex(said, "left out: text.jpg: is not a JPEG or PNG")
        self.assertRegex(said, "left out: other.jpg: no board found")

    def test_too_few_images_are_refused(self):
        folder = self.out.parent / "few"
        folder.mkdir()
        for name in ("100.jpg", "101.jpg"):
            shutil.copy(self.root / "chessboard" / name, folder)
        self.assert_refused("--images", folder, *CHESSBOARD, says="found in 2 of 2 images, at least 3 are needed")

    def test_another_board_is_refused(self):
        self.assert_refused("--images", self.root / "chessboard", "--board", "8x5", "--square", "0.02",
                            says="found in [012] of 13 images.*check --board")

    def test_boards_without_tilt_are_refused(self):
        folder = self.out.parent / "flat"
        shutil.copytree(self.root / "flat", folder)
        (folder / "floor.jpg").unlink()  # the only tilted view
        self.assert_refused("--images", folder, *CHESSBOARD,
                            says="do not constrain the camera.*tilted by 20 to 45 degrees")

    def test_what_makes_no_sense_is_refused(self):
        images = ["--images", self.root / "chessboard"]
        self.assert_refused("--images", self.root / "none", *CHESSBOARD, says="is not a readable folder")
        self.assert_refused(*images, "--board", "9by6", "--square", "0.02", says="not COLUMNSxROWS")
        self.assert_refused(*images, "--board", "9x6", "--square", "20", says="--square takes metres")
        self.assert_refused(*images, "--board", "9x7", "--square", "0.02", *self.floor_options("chessboard"),
                            says="looks the same when turned")
        self.assert_refused(*images, *CHESSBOARD, "--floor-image", "floor.jpg", says="one pose for each floor image")
        self.assert_refused(*images, *CHESSBOARD, "--floor-image", self.root / "none.jpg", "--board-pose", "0,0,0",
                            says="none.jpg: does not exist")
        self.assert_refused(*images, *CHESSBOARD, "--floor-image", "floor.jpg", "--board-pose", "0,zero,0",
                            says="is not x,y,yaw")
        self.assert_refused(*images, *CHESSBOARD, "--charuco", "DICT_4X4_50", code=2, says="--marker")


if __name__ == "__main__":
    unittest.main()
