# SPDX-License-Identifier: Apache-2.0
"""A floor of tiles: `build`, `merge`, `info` and the report say by what it repeats itself."""

import json
import math
import unittest

from builder import Scratch, run_ok

TILE_M = 0.3


class FloorOfTiles(Scratch):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.survey = cls.root / "survey"
        run_ok("simulate", "--texture", "tiles", "--size", "1.6x1.3", "--out", cls.survey)
        cls.map = cls.root / "tiles.floormap"
        cls.report = json.loads(run_ok("build", "--survey", cls.survey, "--out", cls.map, "--no-held-out", "--json",
                                       "--report", cls.root / "report"))

    def check(self, lattices):
        self.assertEqual(len(lattices), 1, lattices)
        lattice = lattices[0]
        for vector in lattice["basis"]:
            self.assertAlmostEqual(math.hypot(*vector), TILE_M, delta=5e-4)
        self.assertAlmostEqual(lattice["basis"][0][0] * lattice["basis"][1][0]
                               + lattice["basis"][0][1] * lattice["basis"][1][1], 0.0, delta=1e-3)
        self.assertGreater(lattice["share"], 0.8)
        self.assertLess(lattice["residual_m"], 1e-3)
        self.assertEqual(lattice["floor_share"], 1.0)

    def test_a_map_holds_the_period_of_its_tiles(self):
        self.check(self.report["lattices"])
        info = json.loads(run_ok("info", self.map, "--json"))
        self.assertEqual(info["lattices"], self.report["lattices"])
        self.assertIn("floor_lattice", [layer["name"] for layer in info["layers"]])
        self.assertNotIn("lattices", info["report"])
        run_ok("verify", self.map)
        self.assertIn("lattice      The floor repeats itself every ", run_ok("info", self.map))
        self.assertEqual(json.loads((self.root / "report" / "report.json").read_text())["lattices"], info["lattices"])
        self.assertIn("The floor repeats itself every", (self.root / "report" / "report.html").read_text())

    def test_a_merged_map_has_its_own(self):
        out = self.folder / "merged.floormap"
        merged = json.loads(run_ok("merge", self.map, self.map, "--same-frame", "--out", out, "--json"))
        self.check(merged["lattices"])
        self.assertEqual(json.loads(run_ok("info", out, "--json"))["lattices"], merged["lattices"])

    def test_results_have_the_pose_modulo_the_lattice(self):
        basis = json.loads(run_ok("info", self.map, "--json"))["lattices"][0]["basis"]
        frames = self.folder / "frames"
        frames.mkdir()
        for name in ("camera.yaml", "floor.yaml", "images"):
            (frames / name).symlink_to(self.survey / name)
        rows = (self.survey / "frames.csv").read_text().splitlines()
        (frames / "frames.csv").write_text("\n".join([rows[0], *rows[1:20]]) + "\n")
        for options in ([], ["--fuse"]):
            results = self.folder / "results.jsonl"
            run_ok("localize", "--map", self.map, "--frames", frames, "--out", self.folder / "est.tum", "--results",
                   results, *options)
            localized = [line for line in map(json.loads, results.read_text().splitlines())
                         if line["status"] == "localized" and "lattice" in line]
            self.assertGreater(len(localized), 0)
            for line in localized:
                seen = line["lattice"]
                self.assertEqual(seen["basis"], basis)
                self.assertGreater(seen["places"], 10)
                apart = (line["x"] - seen["pose"]["x"], line["y"] - seen["pose"]["y"])
                (ax, ay), (bx, by) = basis
                det = ax * by - ay * bx
                whole = ((apart[0] * by - apart[1] * bx) / det, (apart[1] * ax - apart[0] * ay) / det)
                for multiple in whole:
                    self.assertAlmostEqual(multiple, round(multiple), delta=0.01)


if __name__ == "__main__":
    unittest.main(verbosity=2)
