# SPDX-License-Identifier: Apache-2.0
"""Runs the builder on simulated surveys of growing size: time per frame, memory, error against the truth."""

import math
import shutil
import subprocess
import sys
import time

from alignment import geometric_error
from builder import build_map, parse_tum
from limited_process import Limits

SIZES = [250, 1000, 4000, 20000]

# Steps between the built-in camera's images at an overlap of one half, and the floor's margin around their centres.
STEP_ALONG_M = 0.155
STEP_ACROSS_M = 0.2075
MARGIN_M = 0.47

# The camera's resolution on the floor: a finer texture costs memory and adds no detail.
FLOOR_RESOLUTION_M = 0.0007


def floor_side_m(frames):
    return math.sqrt(frames * STEP_ALONG_M * STEP_ACROSS_M) + MARGIN_M


def simulate(binaries, folder, frames):
    """Makes a survey of about this many frames. Returns the seconds it took, or None when it already existed."""
    if folder.exists():
        return None
    side = floor_side_m(frames)
    command = [
        (binaries / "floorloc-mapbuilder").resolve(), "simulate", "--texture", "concrete", "--size", f"{side:.3f}x{side:.3f}",
        "--resolution", f"{FLOOR_RESOLUTION_M}", "--jpeg-quality", "85", "--out", folder,
    ]  # fmt: skip
    start = time.monotonic()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return time.monotonic() - start


def error_of(poses, survey):
    """RMS of the placed frames' base positions against the truth."""
    truth = {stamp: position for stamp, position, _ in parse_tum((survey / "groundtruth.tum").read_text())}
    return geometric_error({stamp: position for stamp, position, _ in poses}, truth, False)


def measure(binaries, state, frames):
    survey = state / f"simulated-{frames}"
    rendering_s = simulate(binaries, survey, frames)
    if rendering_s is not None:
        print(f"bench: rendering {survey} took {rendering_s:.0f} s; it stays for the next time", file=sys.stderr)
    count = len((survey / "frames.csv").read_text(encoding="utf-8").splitlines()) - 1
    folder = state / f"map-{frames}"
    shutil.rmtree(folder, ignore_errors=True)
    outcome, poses = build_map(binaries, [survey], folder, Limits(24 * 3600, 64))
    if outcome.failure:
        print(f"  {count:7}  {outcome.failure}")
        return
    rms, largest = error_of(poses, survey)
    size_mb = (folder / "map.floormap").stat().st_size / 1e6
    print(
        f"  {count:7}{floor_side_m(frames) ** 2:9.0f}{outcome.seconds:10.1f}{count / outcome.seconds:10.1f}"
        f"{1e3 * outcome.cpu_s / count:14.1f}{outcome.peak_mb:10.0f}{size_mb:9.0f}{len(poses):8}{1e3 * rms:9.2f}"
        f"{1e3 * largest:9.2f}",
        flush=True,
    )


def run(binaries, state, largest):
    """Prints one line per size up to the largest."""
    print(
        f"  {'frames':>7}{'m2':>9}{'time, s':>10}{'frames/s':>10}{'CPU ms/frame':>14}{'peak, MB':>10}{'map, MB':>9}"
        f"{'placed':>8}{'RMS, mm':>9}{'max, mm':>9}"
    )
    for frames in [size for size in SIZES if size < largest] + [largest]:
        measure(binaries, state, frames)
