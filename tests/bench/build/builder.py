# SPDX-License-Identifier: Apache-2.0
"""Runs floorloc-mapbuilder for the benchmark."""

import subprocess

from limited_process import run_limited


def parse_tum(text):
    """Rows as (timestamp as written, position as complex number, yaw); rotations are about z."""
    rows = []
    for line in text.splitlines():
        fields = line.split()
        if fields and not line.startswith("#"):
            x, y, qz, qw = (float(fields[i]) for i in (1, 2, 6, 7))
            rows.append((fields[0], complex(x, y), complex(qw, qz) ** 2))
    return rows


def build_map(binaries, surveys, folder, limits):
    """Builds the surveys' map in the folder. Returns the outcome and the frames' poses as from parse_tum."""
    program = (binaries / "floorloc-mapbuilder").resolve()
    folder.mkdir(parents=True, exist_ok=True)
    map_file = folder / "map.floormap"
    map_file.unlink(missing_ok=True)
    poses = folder / "poses.tum"
    command = [program, "build", "--out", map_file]
    for survey in surveys:
        command += ["--survey", survey]
    outcome = run_limited(command, limits)
    if not map_file.exists():  # a map that is not to be used (exit code 3) is compared all the same
        return outcome, []
    subprocess.run([program, "export", map_file, "--poses", poses], check=True, stdout=subprocess.DEVNULL)
    return outcome, parse_tum(poses.read_text(encoding="utf-8"))
