#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the map builder with other stitchers on the same frames, and runs it on surveys of growing size.

`./run bench build` starts it. Every stitcher runs alone, with limits on time and memory.
"""

import argparse
import csv
import pathlib
import shutil
import sys

import hugin
import scaling
import state_folder
from alignment import geometric_error
from builder import build_map
from comparison_table import Row, print_rows
from limited_process import Limits, run_limited


def read_truth(folder):
    """Image name -> true position of its centre, and stamp -> (image name, centre in the base frame)."""
    places, by_stamp = {}, {}
    with open(folder / "truth.csv", newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            places[row["filename"]] = complex(float(row["x"]), float(row["y"]))
            by_stamp[row["timestamp"]] = (row["filename"], complex(float(row["middle_x"]), float(row["middle_y"])))
    return places, by_stamp


def part_of_survey(survey, folder, count, with_odometry):
    """Writes the survey's first frames as a new survey; images are linked, not copied."""
    folder.mkdir(parents=True)
    for name in ["camera.yaml", "floor.yaml"] + (["odometry.tum"] if with_odometry else []):
        if (survey / name).exists():
            shutil.copy(survey / name, folder)
    rows = (survey / "frames.csv").read_text(encoding="utf-8").splitlines()
    (folder / "frames.csv").write_text("\n".join(rows[: count + 1]) + "\n", encoding="utf-8")
    (folder / "images").symlink_to((survey / "images").resolve())
    return folder


class Comparison:
    """Runs all methods on the first frames of one survey."""

    def __init__(self, arguments, survey, count):
        self.arguments = arguments
        self.survey = survey
        self.limits = Limits(arguments.limit_s, arguments.limit_gb)
        self.folder = arguments.state / f"{survey.resolve().parent.name}-{survey.name}-{count}"
        shutil.rmtree(self.folder, ignore_errors=True)
        self.image_folder = self.folder / "rectified"
        outcome = run_limited(
            [arguments.bin / "rectify_frames", survey, self.image_folder, count], Limits(3600, 64)
        )
        if outcome.failure:
            sys.exit(f"bench: {survey}: {outcome.failure}")
        self.places, self.by_stamp = read_truth(self.image_folder)
        self.images = sorted(self.image_folder.resolve().glob("*.png"))

    def row(self, method, outcome, positions, with_scale):
        error = geometric_error(positions, self.places, with_scale)
        return Row(method, len(self.images), outcome, len(positions), error)

    def floorloc(self, with_odometry):
        name = "floorloc" if with_odometry else "floorloc, no odometry"
        folder = self.folder / name.replace(", ", "-").replace(" ", "-")
        survey = part_of_survey(self.survey, folder / "survey", len(self.images), with_odometry)
        outcome, poses = build_map(self.arguments.bin, [survey], folder, self.limits)
        positions = {}
        for stamp, position, heading in poses:
            image, middle = self.by_stamp[stamp]
            positions[image] = position + heading * middle
        return self.row(name, outcome, positions, False)

    def stitcher(self):
        folder = self.folder / "stitcher"
        folder.mkdir()
        command = [self.arguments.bin / "stitch_frames", self.image_folder.resolve(), folder.resolve()]
        outcome = run_limited(command, self.limits)
        positions = {}
        file = folder / "positions.csv"
        if file.exists():
            for line in file.read_text(encoding="utf-8").splitlines():
                image, x, y = line.split(",")
                positions[image] = complex(float(x), float(y))
        return self.row("OpenCV Stitcher", outcome, positions, True)

    def hugin(self):
        folder = self.folder / "hugin"
        folder.mkdir()
        outcome, positions = hugin.stitch(folder.resolve(), self.images, self.places, self.limits)
        return self.row("Hugin", outcome, positions, True)


def compare(arguments):
    without_hugin = hugin.missing_tools()
    if without_hugin:
        print(f"bench: Hugin is left out: {', '.join(without_hugin)} missing (apt-get install hugin-tools enblend)")
    for survey in arguments.surveys:
        # A method that failed is not run on more frames.
        gave_up = set()
        for count in arguments.counts:
            comparison = Comparison(arguments, survey, count)
            methods = {"floorloc": lambda c=comparison: c.floorloc(True)}
            if (survey / "odometry.tum").exists():
                methods["floorloc, no odometry"] = lambda c=comparison: c.floorloc(False)
            methods["OpenCV Stitcher"] = comparison.stitcher
            if not without_hugin:
                methods["Hugin"] = comparison.hugin
            rows = []
            for name, method in methods.items():
                if name not in gave_up:
                    print(f"bench: {survey}, {len(comparison.images)} frames: {name}", file=sys.stderr, flush=True)
                    rows.append(method())
                    if rows[-1].outcome.failure.endswith(("out of time", "out of memory")):
                        gave_up.add(name)
            print(f"\n{survey}, first {len(comparison.images)} frames")
            print_rows(rows)
            if len(comparison.images) < count:
                break


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("surveys", nargs="*", type=pathlib.Path, help="survey folders with ground truth")
    parser.add_argument("--bin", type=pathlib.Path, required=True, help="folder of the binaries")
    parser.add_argument("--state", type=pathlib.Path, required=True, help="folder for what is made on the way")
    parser.add_argument("--counts", type=lambda text: [int(n) for n in text.split(",")], default=[10, 20, 40],
                        help="numbers of frames to compare on (default: 10,20,40)")
    parser.add_argument("--limit-s", type=float, default=600, help="seconds that a method may take (default: 600)")
    parser.add_argument("--limit-gb", type=float, default=8, help="its address space (default: 8)")
    parser.add_argument("--scaling", action="store_true", help="growing surveys instead, the builder alone")
    parser.add_argument("--frames", type=int, default=1000, help="with --scaling: the largest survey (default: 1000)")
    return parser.parse_args()


def main():
    arguments = parse_arguments()
    try:
        state_folder.claim(arguments.state, "build_benchmark")
    except RuntimeError as error:
        sys.exit(f"bench: {error}")
    if arguments.scaling:
        scaling.run(arguments.bin, arguments.state, arguments.frames)
    else:
        compare(arguments)


if __name__ == "__main__":
    main()
