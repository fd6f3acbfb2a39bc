#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of the benchmark's computations."""

import cmath
import math
import pathlib
import random
import sys
import tempfile
import unittest

import hugin
import state_folder
from alignment import fit_motion, geometric_error
from builder import parse_tum
from limited_process import Limits, run_limited


def points(count, seed=1):
    generator = random.Random(seed)
    return [complex(generator.uniform(-1, 1), generator.uniform(-1, 1)) for _ in range(count)]


class Alignment(unittest.TestCase):
    def test_finds_turn_and_shift(self):
        source = points(20)
        factor, shift = fit_motion(source, [cmath.exp(0.3j) * s + (2 - 1j) for s in source], False)
        self.assertAlmostEqual(abs(factor - cmath.exp(0.3j)), 0)
        self.assertAlmostEqual(abs(shift - (2 - 1j)), 0)

    def test_pixels_may_be_scaled_and_mirrored(self):
        truth = dict(enumerate(points(20)))
        pixels = {name: 700 * cmath.exp(1j) * place.conjugate() + 5 for name, place in truth.items()}
        self.assertLess(geometric_error(pixels, truth, True)[0], 1e-9)
        self.assertGreater(geometric_error(pixels, truth, False)[0], 1)

    def test_metres_are_not_scaled(self):
        truth = {0: 0j, 1: 1 + 0j, 2: 0.5 + 0j}
        rms, largest = geometric_error({0: 0j, 1: 1.2 + 0j, 2: 0.6 + 0j}, truth, False)
        self.assertAlmostEqual(rms, math.sqrt(0.02 / 3))
        self.assertAlmostEqual(largest, 0.1)

    def test_two_places_say_nothing(self):
        self.assertIsNone(geometric_error({0: 0j, 1: 1j}, {0: 0j, 1: 1j}, True))


class LimitedProcess(unittest.TestCase):
    def run_python(self, code, seconds=20.0, gigabytes=4.0):
        return run_limited([sys.executable, "-c", code], Limits(seconds, gigabytes))

    def test_success(self):
        outcome = self.run_python("x = bytearray(100 << 20)")
        self.assertEqual(outcome.failure, "")
        self.assertGreater(outcome.peak_mb, 100)

    def test_failures_are_distinguished(self):
        self.assertEqual(self.run_python("import sys; sys.exit('no such thing')").failure, "no such thing")
        self.assertEqual(self.run_python("import os; os.abort()").failure, "killed by SIGABRT")
        self.assertEqual(self.run_python("import time; time.sleep(60)", seconds=0.2).failure, "out of time")
        self.assertEqual(
            self.run_python("try:\n  bytearray(8 << 30)\nexcept MemoryError:\n  raise SystemExit('out of memory')")
            .failure, "out of memory")  # fmt: skip


class Hugin(unittest.TestCase):
    MIDDLE = 300 + 200j

    def project(self, places, pairs):
        """Control points between images at these poses (rotation, shift), as cpfind writes them."""
        lines = ["i w601 h401 f0 v10 r0 p0 y0 TrX0 TrY-1.5e-05 TrZ0 n\"a.png\""]
        for first, second in pairs:
            for point in points(8, seed=first + 10 * second):
                seen = []
                for turn, shift in (places[first], places[second]):
                    seen.append((100 * point - shift) / turn + self.MIDDLE)
                a, b = seen
                lines.append(f"c n{first} N{second} x{a.real} y{a.imag} X{b.real} Y{b.imag} t0")
        return "\n".join(lines)

    def setUp(self):
        self.places = {n: (cmath.exp(0.5j * n), complex(150 * n, -40 * n)) for n in range(4)}

    def test_reads_images(self):
        width, positions = hugin.parse_images(self.project(self.places, []))
        self.assertEqual(width, 601)
        self.assertEqual(positions, {0: -1.5e-05j})

    def test_chains_pairs(self):
        text = self.project(self.places, [(0, 1), (1, 2), (3, 2)])
        pairs = hugin.pairs_of(hugin.parse_control_points(text), self.MIDDLE)
        placed = hugin.chain(pairs)
        self.assertEqual(sorted(placed), [0, 1, 2, 3])
        found = {n: shift for n, (_, shift) in placed.items()}
        self.assertLess(geometric_error(found, {n: shift for n, (_, shift) in self.places.items()}, False)[0], 1e-3)
        turn = placed[3][0] / placed[0][0]
        self.assertAlmostEqual(math.degrees(cmath.phase(turn)), math.degrees(1.5), places=3)

    def test_deletes_false_pairs(self):
        false_places = dict(self.places)
        false_places[3] = (1 + 0j, 20 + 0j)
        text = self.project(self.places, [(0, 1), (1, 2), (2, 3)]) + "\n" + self.project(false_places, [(0, 3)])
        pairs = hugin.pairs_of(hugin.parse_control_points(text), self.MIDDLE)
        self.assertEqual(len(pairs), 4)
        truth = {n: 0.0007 * shift for n, (_, shift) in self.places.items()}
        good = hugin.true_pairs(pairs, truth)
        self.assertEqual(sorted(good), [(0, 1), (1, 2), (2, 3)])
        left = hugin.parse_control_points(hugin.keep_points(text, good))
        self.assertEqual({(p.first, p.second) for p in left}, set(good))


class StateFolder(unittest.TestCase):
    def test_what_others_put_there_is_left_alone(self):
        with tempfile.TemporaryDirectory() as parent:
            folder = pathlib.Path(parent) / "state"
            state_folder.claim(folder, "build_benchmark")
            (folder / "map-40").mkdir()
            state_folder.claim(folder, "build_benchmark")
            with self.assertRaisesRegex(RuntimeError, "not made by another"):
                state_folder.claim(folder, "another")
            with self.assertRaisesRegex(RuntimeError, "new or empty"):
                state_folder.claim(pathlib.Path(parent), "build_benchmark")


class Builder(unittest.TestCase):
    def test_reads_poses(self):
        half = math.radians(45)
        rows = parse_tum(f"# stamp\n12.5 1 2 0 0 0 {math.sin(half)} {math.cos(half)}\n")
        self.assertEqual(rows[0][0], "12.5")
        self.assertAlmostEqual(abs(rows[0][1] - (1 + 2j)), 0)
        self.assertAlmostEqual(abs(rows[0][2] - 1j), 0)


if __name__ == "__main__":
    unittest.main()
