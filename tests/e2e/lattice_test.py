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
        survey = cls.root / "survey"
        run_ok("simulate", "--texture", "tiles", "--size", "1.6x1.3", "--out", survey)
        cls.map = cls.root / "tiles.floormap"
        cls.report = json.loads(run_ok("build", "--survey", survey, "--out", cls.map, "--no-held-out", "--json",
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


if __name__ == "__main__":
    unittest.main(verbosity=2)
