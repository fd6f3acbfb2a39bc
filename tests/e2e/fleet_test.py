# SPDX-License-Identifier: Apache-2.0
"""A simulated fleet of the real floorloc-mapbuilder against the real floorloc-server."""

import json
import pathlib
import signal
import subprocess
import sys
import unittest
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "clients/python"))
SERVER = sys.argv.pop(2)

from builder import BINARY, Scratch, run  # noqa: E402
from real_server import RealServer  # noqa: E402

VEHICLES = 5
SECONDS = 6


class Fleet(Scratch):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        maps = cls.root / "maps"
        maps.mkdir()
        survey = cls.root / "survey"
        for command in (["simulate", "--texture", "concrete", "--size", "1.3x1.1", "--resolution", "0.0007", "--out",
                         survey], ["build", "--survey", survey, "--out", maps / "hall.floormap", "--no-held-out"]):
            subprocess.run([BINARY, *map(str, command)], check=True, capture_output=True, timeout=120)
        cls.server = RealServer(SERVER, maps)
        cls.addClassCleanup(cls.server.stop)

    def vehicles(self):
        with urllib.request.urlopen(f"{self.server.url}/v1/vehicles", timeout=10) as answer:
            return json.load(answer)["vehicles"]

    def test_five_vehicles_are_localized_and_a_kidnapped_one_is_found_again(self):
        result = run("simulate", "--fleet", VEHICLES, "--server", self.server.url, "--seconds", SECONDS, "--rate", "1.5",
                     "--kidnap-every", "4", "--keep", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        summary = json.loads(result.stdout)
        self.assertEqual(summary["map"], "hall")
        self.assertEqual(len(summary["vehicles"]), VEHICLES)
        self.assertGreaterEqual(summary["seconds"], SECONDS)
        kidnaps = [one for vehicle in summary["vehicles"] for one in vehicle["carried"]]
        self.assertTrue([one for one in kidnaps if one["noticed_s"] is not None], kidnaps)
        self.assertIn("is kidnapped", result.stderr)
        for vehicle in summary["vehicles"]:
            self.assertGreater(vehicle["images"], 0, vehicle)
            self.assertGreaterEqual(vehicle["found"], 0.6 * vehicle["images"], vehicle)
            self.assertEqual(vehicle["wrong"], 0, vehicle)
            self.assertLess(vehicle["error_m"]["median"], 0.005, vehicle)
        served = {vehicle["id"]: vehicle for vehicle in self.vehicles()}
        self.assertEqual(sorted(served), [vehicle["id"] for vehicle in summary["vehicles"]])
        for vehicle in summary["vehicles"]:
            self.assertEqual(served[vehicle["id"]]["map"], "hall")
            self.assertEqual(served[vehicle["id"]]["status"], vehicle["status"])

    def test_an_interrupt_ends_it_with_the_summary_and_no_vehicle_left(self):
        with subprocess.Popen([BINARY, "simulate", "--fleet", "2", "--server", self.server.url, "--rate", "2",
                               "--prefix", "agv"], stdout=subprocess.PIPE, text=True) as fleet:
            for line in fleet.stdout:
                if "all vehicles have been localized" in line:
                    break
            self.assertLessEqual({"agv1", "agv2"}, {vehicle["id"] for vehicle in self.vehicles()})
            fleet.send_signal(signal.SIGINT)
            said = fleet.stdout.read()
            self.assertEqual(fleet.wait(20), 0)
        self.assertIn("2 vehicles on map hall", said)
        self.assertFalse([vehicle for vehicle in self.vehicles() if vehicle["id"].startswith("agv")])

    def test_what_cannot_be_driven_is_a_sentence(self):
        for arguments, sentence in ((["--server", "http://127.0.0.1:1"], "no floorloc-server answers"),
                                    (["--server", self.server.url, "--map", "nix"], "it has hall"),
                                    (["--server", self.server.url, "--camera-height", "3"], "too small"),
                                    (["--server", self.server.url, "--silent", "2"], "than there are")):
            result = run("simulate", "--fleet", "1", *arguments)
            self.assertEqual(result.returncode, 1, arguments)
            self.assertIn(sentence, result.stderr)
        for arguments in (["--fleet", "0"], ["--fleet", "501"], ["--fleet", "1", "--out", "x"], ["--rate", "1"]):
            self.assertEqual(run("simulate", *arguments).returncode, 2, arguments)


if __name__ == "__main__":
    unittest.main(verbosity=2)
