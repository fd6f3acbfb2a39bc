# SPDX-License-Identifier: Apache-2.0
"""The real programs: a map of the first frames of the sample survey, and a server of it that can be restarted."""

import csv
import pathlib
import re
import shutil
import subprocess
import sys

sys.dont_write_bytecode = True
ROOT = pathlib.Path(__file__).parents[3]
sys.path.insert(0, str(ROOT / "clients/python"))

SURVEY = ROOT / "maps/sample/survey"
FRAMES = 12


def frames():
    """(stamp, file) of every surveyed frame."""
    with open(SURVEY / "frames.csv", newline="", encoding="utf-8") as file:
        return [(row["timestamp"], SURVEY / row["filename"]) for row in csv.DictReader(file)][:FRAMES]


def build_map(mapbuilder, folder):
    """hall.floormap in the folder."""
    survey = folder / "survey"
    shutil.copytree(SURVEY, survey, ignore=shutil.ignore_patterns("*.jpg"))
    lines = (SURVEY / "frames.csv").read_text(encoding="utf-8").splitlines(keepends=True)
    (survey / "frames.csv").write_text("".join(lines[:FRAMES + 1]), encoding="utf-8")
    for _, file in frames():
        shutil.copy(file, survey / file.relative_to(SURVEY))
    maps = folder / "maps"
    maps.mkdir()
    subprocess.run([mapbuilder, "build", "--survey", survey, "--out", maps / "hall.floormap", "--no-held-out"],
                   check=True, capture_output=True, timeout=120)
    return maps


class RealServer:
    def __init__(self, program, maps, config=None):
        self.command = [program, "--maps", maps] + (["--config", config] if config else [])
        self.port = 0
        self.start()

    def start(self):
        """At the port of the time before."""
        self.process = subprocess.Popen([*self.command, "--listen", f"127.0.0.1:{self.port}"], text=True,
                                        stderr=subprocess.PIPE)
        said = []
        for line in self.process.stderr:
            said.append(line)
            found = re.search(r"http://127\.0\.0\.1:(\d+)/", line)
            if found:
                self.port = int(found.group(1))
                self.url = f"http://127.0.0.1:{self.port}"
                return
        raise AssertionError(f"the server did not start: {''.join(said)}")

    def stop(self):
        self.process.terminate()
        self.process.stderr.read()
        self.process.wait(20)
        self.process.stderr.close()
