# SPDX-License-Identifier: Apache-2.0
"""Runs Hugin's command line tools on top-down images of a plane: control points, positions, mosaic."""

import cmath
import collections
import dataclasses
import math
import re
import shutil
import statistics
import time

from alignment import distances_after_fit, fit_motion, rms
from limited_process import Limits, Outcome, run_limited

TOOLS = ["pto_gen", "cpfind", "cpclean", "pto_var", "autooptimiser", "pano_modify", "nona", "enblend"]

# A narrow field of view, so that translation and rotation of the camera are distinguishable.
FIELD_OF_VIEW_DEG = 10.0

# With Hugin's defaults (rotating camera, half the resolution, few points) cpfind finds hardly any points on floors.
CPFIND_OPTIONS = [
    "--fullscale",
    "--multirow",
    "--ransacmode=hom",
    "--kdtreesteps=400",
    "--kdtreeseconddist=0.6",
    "--sieve1size=300",
]

# cpfind accepts homographies between images that do not overlap, and one false pair ruins a whole mosaic. In Hugin's
# favour, pairs that a user would delete by hand are removed: those that fit no rigid motion, and those whose distance
# differs from the truth.
MIN_POINTS_OF_PAIR = 5
MAX_PAIR_RMS_PX = 2.0
MAX_DISTANCE_ERROR = 0.05


def missing_tools():
    return [tool for tool in TOOLS if shutil.which(tool) is None]


@dataclasses.dataclass
class ControlPoint:
    first: int
    second: int
    in_first: complex  # pixels
    in_second: complex


def parse_control_points(text):
    points = []
    for line in text.splitlines():
        if line.startswith("c "):
            f = dict(re.findall(r"\b([nNxyXY])(-?[\d.]+(?:e-?\d+)?)", line))
            first, second = complex(float(f["x"]), float(f["y"])), complex(float(f["X"]), float(f["Y"]))
            points.append(ControlPoint(int(f["n"]), int(f["N"]), first, second))
    return points


def parse_images(text):
    """Width of the images, and number -> (TrX, TrY)."""
    width = 0
    positions = {}
    for line in text.splitlines():
        if line.startswith("i "):
            width = int(re.search(r"\bw(\d+)", line).group(1))
            x = float(re.search(r"\bTrX(-?[\d.]+(?:e-?\d+)?)", line).group(1))
            y = float(re.search(r"\bTrY(-?[\d.]+(?:e-?\d+)?)", line).group(1))
            positions[len(positions)] = complex(x, y)
    return width, positions


@dataclasses.dataclass
class Pair:
    points: list
    turn: complex  # first = turn * second + shift, pixels from the image centres
    shift: complex


def pairs_of(points, middle):
    """Pairs of images whose control points fit a rigid motion: (first, second) -> Pair."""
    grouped = collections.defaultdict(list)
    for point in points:
        grouped[point.first, point.second].append(point)
    pairs = {}
    for numbers, of_pair in grouped.items():
        source = [p.in_second - middle for p in of_pair]
        target = [p.in_first - middle for p in of_pair]
        if len(of_pair) < MIN_POINTS_OF_PAIR or rms(distances_after_fit(source, target, False)) > MAX_PAIR_RMS_PX:
            continue
        pairs[numbers] = Pair(of_pair, *fit_motion(source, target, False))
    return pairs


def chain(pairs):
    """Poses of the images connected to the best connected one: number -> (turn, shift). A maximum spanning tree by the
    number of control points."""
    neighbours = collections.defaultdict(list)
    for (first, second), pair in pairs.items():
        neighbours[first].append((len(pair.points), second, pair.turn, pair.shift))
        neighbours[second].append((len(pair.points), first, 1 / pair.turn, -pair.shift / pair.turn))
    if not neighbours:
        return {}
    start = max(neighbours, key=lambda n: sum(entry[0] for entry in neighbours[n]))
    placed = {start: (1 + 0j, 0j)}
    edges = [(count, start, *rest) for count, *rest in neighbours[start]]
    while edges:
        edge = max(edges, key=lambda e: e[0])
        edges.remove(edge)
        _, origin, number, turn, shift = edge
        if number not in placed:
            origin_turn, origin_shift = placed[origin]
            placed[number] = (origin_turn * turn, origin_turn * shift + origin_shift)
            edges += [(count, number, *rest) for count, *rest in neighbours[number]]
    return placed


def true_pairs(pairs, truth):
    """The pairs whose distance agrees with the truth (number -> position, any unit)."""
    ratios = {(a, b): abs(truth[b] - truth[a]) / abs(pair.shift) for (a, b), pair in pairs.items() if pair.shift != 0}
    if not ratios:
        return {}
    usual = statistics.median(ratios.values())
    return {numbers: pairs[numbers] for numbers, ratio in ratios.items() if abs(ratio / usual - 1) < MAX_DISTANCE_ERROR}


def keep_points(text, pairs):
    """The project file with the control points of these pairs only."""
    lines = []
    for line in text.splitlines():
        found = parse_control_points(line)
        if not found or (found[0].first, found[0].second) in pairs:
            lines.append(line)
    return "\n".join(lines) + "\n"


def focal_px(width):
    return 0.5 * width / math.tan(math.radians(0.5 * FIELD_OF_VIEW_DEG))


def start_values(placed, width):
    """Initial values in pto_var's syntax: with all images at the origin the optimiser does not converge."""
    values = []
    for number, (turn, shift) in sorted(placed.items()):
        at = shift / focal_px(width)
        values.append(f"TrX{number}={at.real:.8f},TrY{number}={at.imag:.8f},r{number}={math.degrees(cmath.phase(turn)):.5f}")
    return ",".join(values)


class Hugin:
    """One project: a sequence of steps with a common time limit; the first failure ends it."""

    def __init__(self, folder, images, truth, limits):
        self.folder = folder
        self.images = images
        self.truth = dict(enumerate(truth))
        self.limits = limits
        self.start = time.monotonic()
        self.total = Outcome(0.0, 0.0, 0.0, "")
        self.positions = {}
        self.placed = {}

    def step(self, *command):
        if self.total.failure:
            return False
        left_s = self.limits.seconds - (time.monotonic() - self.start)
        outcome = run_limited(command, Limits(max(0.1, left_s), self.limits.gigabytes), self.folder)
        self.total.cpu_s += outcome.cpu_s
        self.total.peak_mb = max(self.total.peak_mb, outcome.peak_mb)
        self.total.failure = f"{command[0]}: {outcome.failure}" if outcome.failure else ""
        return not outcome.failure

    def read(self, name):
        return (self.folder / name).read_text(errors="replace")

    def find_positions(self):
        fov = f"{FIELD_OF_VIEW_DEG:g}"
        if not (
            self.step("pto_gen", "-p", "0", "-f", fov, "-o", "empty.pto", *self.images)
            and self.step("cpfind", *CPFIND_OPTIONS, "-o", "points.pto", "empty.pto")
            and self.step("cpclean", "-o", "clean.pto", "points.pto")
        ):
            return
        width, _ = parse_images(self.read("clean.pto"))
        height = int(re.search(r"^i .*?\bh(\d+)", self.read("clean.pto"), re.M).group(1))
        middle = complex(0.5 * (width - 1), 0.5 * (height - 1))
        pairs = true_pairs(pairs_of(parse_control_points(self.read("clean.pto")), middle), self.truth)
        self.placed = chain(pairs)
        if len(self.placed) < 2:
            self.total.failure = "cpfind: no images that overlap"
            return
        (self.folder / "good.pto").write_text(keep_points(self.read("clean.pto"), pairs))
        free = ",".join(f"TrX{n},TrY{n},r{n}" for n in sorted(self.placed)[1:])
        if (
            self.step("pto_var", f"--set={start_values(self.placed, width)}", "-o", "start.pto", "good.pto")
            and self.step("pto_var", f"--opt={free}", "-o", "variables.pto", "start.pto")
            and self.step("autooptimiser", "-n", "-o", "optimised.pto", "variables.pto")
        ):
            _, positions = parse_images(self.read("optimised.pto"))
            self.positions = {n: p for n, p in positions.items() if n in self.placed}

    def compose(self):
        self.step("pano_modify", "--projection=0", "--fov=AUTO", "--canvas=AUTO", "--crop=AUTO", "-o", "canvas.pto",
                  "optimised.pto")
        self.step("nona", "-m", "TIFF_m", "-o", "warped", "canvas.pto")
        if not self.total.failure:
            self.step("enblend", "-o", "mosaic.tif", *sorted(p.name for p in self.folder.glob("warped*.tif")))

    def run(self):
        self.find_positions()
        if self.positions:
            self.compose()
        self.total.seconds = time.monotonic() - self.start
        return self.total


def stitch(folder, images, truth, limits):
    """Outcome, and image name -> position (any unit). truth: name -> true position, to remove false control points."""
    project = Hugin(folder, images, [truth[image.name] for image in images], limits)
    outcome = project.run()
    return outcome, {images[n].name: p for n, p in project.positions.items()}
