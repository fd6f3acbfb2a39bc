#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A robot's loop: odometry at every step, an image whenever the server wants one.

Here both come from a recorded drive; put your wheels and camera in the places marked ROBOT.

    examples/robot_loop.py --server http://localhost:8080 --map sample --drive maps/sample/kidnap
"""

import argparse
import csv
import math
import pathlib
import sys

# Or pip install ./clients/python:
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "clients/python"))
from floorloc import Client, FloorlocError, read_calibration, ros  # noqa: E402

DEADLINE_S = 0.3  # an older pose would be of no use to this robot


def read_odometry(folder):
    """ROBOT: (time, motion in the base frame since the last one) as the wheels say it."""
    before = None
    for line in (folder / "odometry.tum").read_text(encoding="utf-8").splitlines():
        if line.startswith("#"):
            continue
        stamp, x, y, _, _, _, qz, qw = map(float, line.split())
        pose = ros.Planar(x, y, 2.0 * math.atan2(qz, qw))
        if before is not None:
            yield stamp, before.inverse() * pose
        before = pose


def read_frames(folder):
    """ROBOT: (time as written, JPEG file) of the camera."""
    with open(folder / "frames.csv", newline="", encoding="utf-8") as file:
        return [(row["timestamp"], folder / row["filename"]) for row in csv.DictReader(file)]


def show(stamp, answer):
    pose = answer.get("pose")
    where = f"{pose['x']:.4f} {pose['y']:.4f} {pose['yaw']:.4f}" if pose else "nowhere yet"
    print(f"{stamp} {answer['status']} {where}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--server", default="http://127.0.0.1:8080")
    parser.add_argument("--map", required=True)
    parser.add_argument("--drive", required=True, type=pathlib.Path, help="recording in the survey format")
    arguments = parser.parse_args()
    frames = read_frames(arguments.drive)
    with Client(arguments.server) as client:
        vehicle = client.register("python-example", arguments.map, **read_calibration(arguments.drive))
        for time_s, motion in read_odometry(arguments.drive):
            try:
                vehicle.move(time_s, *motion, deadline_s=DEADLINE_S)
                while frames and float(frames[0][0]) <= time_s:
                    stamp, file = frames.pop(0)
                    if vehicle.wants_frame(float(stamp)):
                        show(stamp, vehicle.frame(file.read_bytes(), stamp, deadline_s=DEADLINE_S))
            except FloorlocError as error:  # the robot goes on; its odometry is kept and sent with the next step
                print(f"{time_s} {error}", file=sys.stderr)


if __name__ == "__main__":
    main()
