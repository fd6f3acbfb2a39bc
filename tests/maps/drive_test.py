#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of the demo's client that need no server."""

import cmath
import math
import pathlib
import random
import sys
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "maps"))
import drive  # noqa: E402


class DriveTest(unittest.TestCase):
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
