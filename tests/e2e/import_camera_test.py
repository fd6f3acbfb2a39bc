# SPDX-License-Identifier: Apache-2.0
"""`import-camera` of the real floorloc-mapbuilder: other tools' calibrations become camera.yaml and floor.yaml.
Usage: import_camera_test.py MAPBUILDER"""

import unittest

import yaml
from builder import Scratch, run, run_ok

CAMCHAIN = """cam0:
  camera_model: pinhole
  distortion_coeffs: [-0.1, 0.01, 0.001, -0.0005]
  distortion_model: radtan
  intrinsics: [600.0, 602.0, 321.0, 239.0]
  resolution: [640, 480]
  rostopic: /cam0/image_raw
"""
LOOKING_DOWN = "0.2,0.1,0.4,3.14159265,0,-1.57079633"


class ImportCamera(Scratch):
    def setUp(self):
        super().setUp()
        self.file = self.folder / "camchain.yaml"
        self.file.write_text(CAMCHAIN)
        self.out = self.folder / "survey"

    def refused(self, *arguments):
        result = run("import-camera", *arguments)
        self.assertEqual(result.returncode, 1, result.stdout)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        return result.stderr

    def test_the_camera_comes_over_and_the_floor_is_said_to_be_missing(self):
        said = run_ok("import-camera", self.file, "--out", self.out)
        self.assertIn("from a camchain of Kalibr, 640x480, plumb_bob", said)
        self.assertIn("floor.yaml is missing", said)
        self.assertIn("--base-from-camera", said)
        camera = yaml.safe_load((self.out / "camera.yaml").read_text())
        self.assertEqual(camera["camera_matrix"]["data"], [600, 0, 321, 0, 602, 239, 0, 0, 1])
        self.assertEqual(camera["distortion_coefficients"]["data"], [-0.1, 0.01, 0.001, -0.0005])
        self.assertFalse((self.out / "floor.yaml").exists())

    def test_the_pose_on_the_robot_makes_the_floor(self):
        run_ok("import-camera", self.file, "--base-from-camera", LOOKING_DOWN, "--out", self.out)
        floor = yaml.safe_load((self.out / "floor.yaml").read_text())
        h = floor["homography"]
        for (u, v), (x, y) in {(321, 239): (0.2, 0.1), (381, 239): (0.2, 0.06), (321, 299.2): (0.16, 0.1)}.items():
            px, py, w = (h[3 * row] * u + h[3 * row + 1] * v + h[3 * row + 2] for row in range(3))
            self.assertAlmostEqual(px / w, x, delta=1e-6)
            self.assertAlmostEqual(py / w, y, delta=1e-6)
        run_ok("simulate", "--texture", "concrete", "--size", "1.2x0.9", "--trajectory", "random", "--frames", "2",
               "--camera-yaml", self.out / "camera.yaml", "--floor-yaml", self.out / "floor.yaml",
               "--out", self.folder / "simulated")

    def test_out_may_be_the_file_itself(self):
        run_ok("import-camera", self.file, "--base-from-camera", LOOKING_DOWN, "--out", self.out / "front.yaml")
        self.assertIn("plumb_bob", (self.out / "front.yaml").read_text())
        self.assertTrue((self.out / "floor.yaml").exists())

    def test_a_survey_with_such_a_file_names_the_command_that_mends_it(self):
        self.out.mkdir()
        (self.out / "camera.yaml").write_text(CAMCHAIN)
        result = run("build", "--survey", self.out, "--out", self.folder / "m.floormap")
        self.assertEqual(result.returncode, 1)
        command = f"import-camera {self.out}/camera.yaml --out {self.out}"
        self.assertIn(f"'floorloc-mapbuilder {command}'", result.stderr)
        self.assertIn("camera.original.yaml", run_ok(*command.split()))
        self.assertEqual((self.out / "camera.original.yaml").read_text(), CAMCHAIN)
        self.assertIn("plumb_bob", (self.out / "camera.yaml").read_text())

    def test_what_makes_no_sense_is_refused(self):
        out = ("--out", self.out)
        self.assertIn("optical frame", self.refused(self.file, *out, "--base-from-camera", "0.2,0,0.4,0,0,0"))
        self.assertIn("above the floor", self.refused(self.file, *out, "--base-from-camera", "0,0,-0.4,3.14,0,0"))
        self.assertIn("--camera may be cam0", self.refused(self.file, *out, "--camera", "cam7"))
        self.assertIn("cannot be opened", self.refused(self.folder / "none.yaml", *out))
        self.assertIn("is not WIDTHxHEIGHT", self.refused(self.file, *out, "--size", "640"))
        self.assertEqual(run("import-camera", self.file, *out, "--roi", "0,1,0,1").returncode, 2)
        self.assertFalse((self.out / "camera.yaml").exists())


if __name__ == "__main__":
    unittest.main()
