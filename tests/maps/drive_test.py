#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of the demo's client that need no server."""

import cmath
import math
import pathlib
import random
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "maps"))
import drive  # noqa: E402


def write_temporary(text):
    with tempfile.NamedTemporaryFile("w", delete=False) as file:
        file.write(text)
    return pathlib.Path(file.name)


class DriveTest(unittest.TestCase):
    def test_yaml_of_a_camera_becomes_a_dictionary(self):
        file = write_temporary("""# a comment
image_width: 640
camera_name: front  # another
camera_matrix:
  rows: 3
  data: [598.5, 0.0,
         1e-3]
roi: {x_min: -0.1, x_max: 0.2}
nested:
  flat: "text"
""")
        self.addCleanup(file.unlink)
        self.assertEqual(drive.read_yaml(file), {
            "image_width": 640,
            "camera_name": "front",
            "camera_matrix": {"rows": 3, "data": [598.5, 0.0, 0.001]},
            "roi": {"x_min": -0.1, "x_max": 0.2},
            "nested": {"flat": "text"},
        })

    def test_a_vehicle_registers_its_mask_where_there_is_one(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "camera.yaml").write_text("image_width: 640\n")
            (folder / "floor.yaml").write_text("resolution: 0.0007\n")
            body = drive.registration("hall", folder)
            self.assertEqual(body, {"map": "hall", "camera": {"image_width": 640}, "floor": {"resolution": 0.0007}})
            (folder / "mask.png").write_bytes(b"PNG")
            self.assertEqual(drive.registration("hall", folder)["mask"], "UE5H")

    def test_alignment_recovers_a_motion_despite_wrong_answers(self):
        seeded = random.Random(1)
        rotation, translation = cmath.exp(2.5j), complex(3, -2)
        points = [complex(seeded.uniform(0, 2), seeded.uniform(0, 2)) for _ in range(40)]
        pairs = [(point, rotation * point + translation + (1 if number < 4 else 0))
                 for number, point in enumerate(points)]
        found_rotation, found_translation = drive.align(pairs)
        self.assertAlmostEqual(found_rotation, rotation, places=9)
        self.assertAlmostEqual(found_translation, translation, places=9)

    def test_errors_are_zero_between_two_frames_of_one_drive(self):
        poses = [((complex(x, x * x), 0.1 * x), (complex(x, x * x) * 1j + 5, 0.1 * x + math.pi / 2)) for x in range(9)]
        for position_m, yaw_rad in drive.errors_against_truth(poses):
            self.assertLess(position_m, 1e-9)
            self.assertLess(yaw_rad, 1e-9)

    def test_truth_is_interpolated_over_the_wrap_of_the_angle(self):
        truth = ([0.0, 1.0], [(0j, math.pi - 0.1), (2 + 0j, -math.pi + 0.1)])
        position, yaw = drive.truth_at(truth, 0.5)
        self.assertAlmostEqual(position, 1 + 0j)
        self.assertAlmostEqual(abs(drive.wrap(yaw)), math.pi)
        self.assertIsNone(drive.truth_at(truth, 1.5))
        self.assertIsNone(drive.truth_at(truth, -0.5))

    def test_percentile_of_one_hundred_values(self):
        self.assertEqual(drive.percentile(list(range(100)), 0.99), 99)
        self.assertEqual(drive.percentile([7], 0.99), 7)


if __name__ == "__main__":
    unittest.main()
