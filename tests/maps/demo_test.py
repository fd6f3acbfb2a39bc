#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The demo with the real programs: builds and serves the sample map; both clients must succeed.
Arguments: floorloc-mapbuilder, floorloc-server."""

import pathlib
import socket
import subprocess
import sys
import tempfile
import unittest

MAPBUILDER, SERVER = sys.argv[1:3]
del sys.argv[1:3]
MAPS = pathlib.Path(__file__).parents[2] / "maps"


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class DemoTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = cls.enterClassContext(tempfile.TemporaryDirectory(prefix="floorloc-demo-"))
        subprocess.run([MAPBUILDER, "build", "--survey", MAPS / "sample/survey", "--out", f"{folder}/sample.floormap",
                        "--no-held-out"], check=True, capture_output=True, timeout=300)
        cls.url = f"http://127.0.0.1:{free_port()}"
        log = cls.enterClassContext(open(f"{folder}/server.log", "w"))
        server = subprocess.Popen([SERVER, "--maps", folder, "--listen", cls.url.removeprefix("http://")],
                                  stdout=log, stderr=log)
        cls.addClassCleanup(server.wait, 60)
        cls.addClassCleanup(server.terminate)

    def client(self, program, frames):
        result = subprocess.run([sys.executable, MAPS / program, "--server", self.url, "--map", "sample",
                                 "--frames", MAPS / frames], capture_output=True, text=True, timeout=300)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        return result.stdout

    def test_every_frame_of_the_drive_is_localized(self):
        self.assertIn("120/120 frames sent, 120 localized", self.client("drive.py", "sample/drive"))

    def test_the_kidnapped_vehicle_is_found_again_each_time(self):
        for _ in range(2):  # a second drive of the same vehicle restarts it
            printed = self.client("vehicle.py", "sample/kidnap")
            self.assertEqual(printed.count("kidnapped: lifted and put down elsewhere"), 2)
            self.assertEqual(printed.count("found again after"), 2)


if __name__ == "__main__":
    unittest.main()
