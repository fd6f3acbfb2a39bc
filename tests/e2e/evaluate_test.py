# SPDX-License-Identifier: Apache-2.0
"""Trajectory errors of the real floorloc-mapbuilder, checked against a second implementation of their definitions."""

import itertools
import json
import math
import unittest

import builder
import trajectory_oracle as oracle

SEEDS = (3, 4)
ALIGNMENTS = ("none", "se2", "se3", "sim3", "scale", "origin")
DELTAS = ((1, "frames"), (7, "frames"), (0.5, "m"), (1.3, "m"), (20, "deg"), (90, "deg"), (0.6, "rad"))


class Evaluate(builder.Scratch):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.drives = {}
        for seed in SEEDS:
            drive = oracle.random_drive(seed)
            files = [cls.root / f"{seed}-{name}.tum" for name in ("reference", "estimate")]
            for file, trajectory in zip(files, drive):
                file.write_text(oracle.as_tum(trajectory))
            cls.drives[seed] = (drive, files)

    def evaluate(self, metric, *arguments):
        return json.loads(builder.run_ok("evaluate", metric, *arguments, "--json"))

    def expect_same(self, found, expected, what):
        for relation, values in expected.items():
            for name, value in values.items():
                self.assertAlmostEqual(found[relation][name], value, delta=1e-7 * max(1.0, abs(value)),
                                       msg=f"{what}: {relation} {name}")
        for name, value in expected["rotation"].items():
            in_degrees = value * math.degrees(1) ** (2 if name == "sse" else 1)
            self.assertAlmostEqual(found["rotation_deg"][name], in_degrees, delta=1e-5 * max(1.0, in_degrees))

    def test_absolute_errors_in_every_alignment(self):
        for seed, align in itertools.product(SEEDS, ALIGNMENTS):
            (reference, estimate), files = self.drives[seed]
            found = self.evaluate("ape", *files, "--align", align)
            expected, count, scale = oracle.evaluate(reference, estimate, align)
            self.assertEqual(found["pairs"], count)
            self.assertAlmostEqual(found["alignment"]["scale"], scale, places=9)
            self.expect_same(found, expected, f"seed {seed}, {align}")
        self.assertNotIn("delta", found)

    def test_relative_errors_over_every_delta(self):
        for (delta, unit), all_pairs in itertools.product(DELTAS, (False, True)):
            (reference, estimate), files = self.drives[SEEDS[0]]
            flags = ["--all-pairs"] if all_pairs else []
            found = self.evaluate("rpe", *files, "--align", "sim3", "--delta", delta, "--delta-unit", unit, *flags)
            expected, count, _ = oracle.evaluate(reference, estimate, "sim3",
                                                 motions_of=lambda p: oracle.motions(p, delta, unit, all_pairs))
            what = f"{delta} {unit}, all pairs: {all_pairs}"
            self.assertEqual((found["motions"], found["delta"], found["delta_unit"], found["all_pairs"]),
                             (count, delta, unit, all_pairs), what)
            self.expect_same(found, expected, what)

    def test_lengths_along_the_reference(self):
        (reference, estimate), files = self.drives[SEEDS[1]]
        true_poses = [r for r, _ in oracle.associate(reference, estimate, 0.01)]
        found = self.evaluate("rpe", *files, "--delta", 1, "--delta-unit", "m", "--pairs-from-reference")
        expected, count, _ = oracle.evaluate(
            reference, estimate, motions_of=lambda _: oracle.motions(true_poses, 1, "m", False))
        self.assertEqual(found["motions"], count)
        self.expect_same(found, expected, "along the reference")
        self.assertNotEqual(self.evaluate("rpe", *files, "--delta", 1, "--delta-unit", "m")["motions"], count)

    def test_time(self):
        (reference, estimate), files = self.drives[SEEDS[0]]
        found = self.evaluate("ape", *files, "--max-diff", "0.02", "--align", "se3")
        expected, count, _ = oracle.evaluate(reference, estimate, "se3", max_diff=0.02)
        self.assertEqual(found["pairs"], count)
        self.expect_same(found, expected, "other pairs")
        late = self.folder / "late.tum"
        late.write_text(oracle.as_tum([(t + 3.5, p, q) for t, p, q in estimate]))
        shifted = self.evaluate("ape", files[0], late, "--time-offset", "-3.5", "--max-diff", "0.02", "--align", "se3")
        self.expect_same(shifted, expected, "shifted back")

    def test_by_hand(self):
        """A square driven at 1 m/s and an estimate one metre above it that turns twice as much, computed by hand."""
        reference, estimate = self.folder / "reference.tum", self.folder / "estimate.tum"
        corners = [(0, 0, 0), (1, 0, 90), (1, 1, 180), (0, 1, 270)]
        for file, height, factor in ((reference, 0, 1), (estimate, 1, 2)):
            rows = []
            for i, (x, y, yaw) in enumerate(corners):
                half = math.radians(factor * yaw) / 2
                rows.append((i, [float(x), float(y), float(height)], [math.cos(half), 0.0, 0.0, math.sin(half)]))
            file.write_text(oracle.as_tum(rows))
        found = self.evaluate("ape", reference, estimate)
        self.assertEqual((found["translation"]["min"], found["translation"]["max"]), (1, 1))
        self.assertAlmostEqual(found["rotation_deg"]["max"], 180)
        self.assertAlmostEqual(found["rotation_deg"]["median"], 90)
        # Rotation by 180 degrees, |R - I|^2 = 4 + 4, and translation by 1 m.
        self.assertAlmostEqual(found["full"]["max"], 3)
        flat = self.evaluate("ape", reference, estimate, "--planar")
        self.assertEqual(flat["translation"]["max"], 0)
        relative = self.evaluate("rpe", reference, estimate, "--delta", "1", "--delta-unit", "s")
        self.assertEqual(relative["motions"], 3)
        self.assertAlmostEqual(relative["rotation_deg"]["mean"], 90)

    def test_writes_an_image_and_every_error(self):
        _, files = self.drives[SEEDS[0]]
        image, errors = self.folder / "plot.png", self.folder / "errors.csv"
        found = self.evaluate("rpe", *files, "--delta", "90", "--delta-unit", "deg", "--all-pairs", "--plot", image,
                              "--plot-error", "rotation", "--errors", errors)
        self.assertEqual(image.read_bytes()[:4], b"\x89PNG")
        rows = [line.split(",") for line in errors.read_text().splitlines()]
        self.assertEqual(rows[0], ["timestamp", "translation_m", "rotation_rad", "full"])
        self.assertEqual(len(rows) - 1, found["motions"])
        self.assertAlmostEqual(max(float(row[2]) for row in rows[1:]), found["rotation"]["max"], places=7)
        table = builder.run_ok("evaluate", "rpe", *files, "--delta", "0.5", "--delta-unit", "m")
        self.assertIn("rpe over 0.5 m, alignment none", table)
        self.assertIn("full [-]", table)

    def expect_sentence(self, code, part, *arguments):
        result = builder.run("evaluate", *arguments)
        self.assertEqual((result.returncode, result.stdout), (code, ""), result.stderr)
        self.assertIn(part, result.stderr)
        if code == 1:
            self.assertEqual(len(result.stderr.strip().splitlines()), 1, result.stderr)

    def test_bad_input_is_one_sentence(self):
        _, (reference, estimate) = self.drives[SEEDS[0]]
        bad = self.folder / "bad.tum"
        row = "{} {} 0 0 0 0 0 1\n"
        self.expect_sentence(1, "missing.tum", "ape", reference, self.folder / "missing.tum")
        for text, part in (("", "has no poses"), ("# nothing\n", "has no poses"),
                           (row.format(1000, "nan"), "bad.tum:1"), (row.format("nan", 0), "bad.tum:1"),
                           (row.format(1000, 0) * 2, "bad.tum:2"),
                           (row.format(1001, 0) + row.format(1000, 0), "bad.tum:2"),
                           (row.format(2000, 0), "only 0 of its 1 poses")):
            bad.write_text(text)
            self.expect_sentence(1, part, "ape", reference, bad)
        bad.write_text(row.format(1000, 0))
        self.assertEqual(self.evaluate("ape", reference, bad, "--align", "origin")["pairs"], 1)
        self.expect_sentence(1, "at least 2", "ape", reference, bad, "--align", "sim3")
        self.expect_sentence(1, "at least 2", "rpe", reference, bad)
        straight = "".join(row.format(1000 + i, 0.37 * i) for i in range(9))
        bad.write_text(straight)
        self.expect_sentence(1, "align with se2", "ape", bad, bad, "--align", "sim3")
        self.expect_sentence(1, "no motion as long as delta", "rpe", bad, bad, "--delta", "100", "--delta-unit", "m")
        self.expect_sentence(1, "whole number", "rpe", bad, bad, "--delta", "1.5")
        self.expect_sentence(1, "half a turn", "rpe", bad, bad, "--delta", "181", "--delta-unit", "deg")
        self.expect_sentence(2, "--delta", "rpe", bad, bad, "--delta", "0")
        self.expect_sentence(2, "--align", "ape", bad, bad, "--align", "sim2")


if __name__ == "__main__":
    unittest.main(verbosity=2)
