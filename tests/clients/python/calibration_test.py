#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reading camera.yaml, floor.yaml and mask.png, as a vehicle registers them."""

import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parents[3] / "clients/python"))
from floorloc import calibration  # noqa: E402


class CalibrationTest(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def read(self, text):
        (self.folder / "some.yaml").write_text(text)
        return calibration.read_yaml(self.folder / "some.yaml")

    def test_yaml_of_a_camera_becomes_a_dictionary(self):
        self.assertEqual(self.read("""# a comment
image_width: 640
camera_name: front  # another
camera_matrix:
  rows: 3
  data: [598.5, 0.0,
         1e-3]
roi: {x_min: -0.1, x_max: 0.2}
nested:
  flat: "text"
"""), {
            "image_width": 640,
            "camera_name": "front",
            "camera_matrix": {"rows": 3, "data": [598.5, 0.0, 0.001]},
            "roi": {"x_min": -0.1, "x_max": 0.2},
            "nested": {"flat": "text"},
        })

    def test_lists_of_lines_are_refused_instead_of_lost(self):
        with self.assertRaisesRegex(ValueError, "in brackets"):
            self.read("homography:\n  - 1\n  - 2\n")

    def test_a_mask_is_read_where_there_is_one(self):
        (self.folder / "camera.yaml").write_text("image_width: 640\n")
        (self.folder / "floor.yaml").write_text("resolution: 0.0007\n")
        read = calibration.read_calibration(self.folder)
        self.assertEqual(read, {"camera": {"image_width": 640}, "floor": {"resolution": 0.0007}})
        (self.folder / "mask.png").write_bytes(b"PNG")
        self.assertEqual(calibration.read_calibration(str(self.folder))["mask"], "UE5H")


if __name__ == "__main__":
    unittest.main()
