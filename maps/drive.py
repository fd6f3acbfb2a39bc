#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Localizes every frame of a folder over HTTP and compares the answers with the ground truth.

Also an example of clients/python, whose client it uses. Start it while a server runs:

    maps/drive.py --server http://127.0.0.1:8080 --map sample --frames maps/sample/drive
"""

import argparse
import bisect
import cmath
import csv
import math
import pathlib
import statistics
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "clients/python"))
import floorloc  # noqa: E402

MAX_ERROR_M = 0.010
MAX_ERROR_RAD = math.radians(1.0)
REQUIRED_SUCCESS = 0.90


def registration(map_name, folder):
    """What a vehicle tells the server of itself: its camera, and where its own body is in the images."""
    return {"map": map_name, **floorloc.read_calibration(folder)}


def read_frames(folder):
    """(timestamp as written, image) of every frame."""
    with open(folder / "frames.csv", newline="") as file:
        return [(row["timestamp"], folder / row["filename"]) for row in csv.DictReader(file)]


def read_truth(file):
    """Times and poses (position as a complex number, yaw) of a TUM trajectory."""
    times, poses = [], []
    for line in file.read_text().splitlines():
        if line and not line.startswith("#"):
            time_s, x, y, _, qx, qy, qz, qw = map(float, line.split())
            times.append(time_s)
            poses.append((complex(x, y), math.atan2(2 * (qw * qz + qx * qy), 1 - 2 * (qy * qy + qz * qz))))
    return times, poses


def truth_at(truth, time_s):
    """The pose at a time, interpolated linearly; None outside of the trajectory."""
    times, poses = truth
    after = bisect.bisect_left(times, time_s - 1e-6)
    if after < len(times) and abs(times[after] - time_s) <= 1e-6:
        return poses[after]
    if after in (0, len(times)):
        return None
    share = (time_s - times[after - 1]) / (times[after] - times[after - 1])
    (position_a, yaw_a), (position_b, yaw_b) = poses[after - 1], poses[after]
    return position_a + share * (position_b - position_a), yaw_a + share * wrap(yaw_b - yaw_a)


def wrap(angle):
    return math.remainder(angle, 2 * math.pi)


def align(pairs):
    """Rotation (unit complex number) and translation from map to true positions, by least squares over the best four
    fifths of the pairs, so that they are robust to wrong poses."""
    kept = pairs
    for _ in range(3):
        estimate_mean = sum(estimate for estimate, _ in kept) / len(kept)
        truth_mean = sum(truth for _, truth in kept) / len(kept)
        spin = sum((truth - truth_mean) * (estimate - estimate_mean).conjugate() for estimate, truth in kept)
        rotation = spin / abs(spin) if spin else 1
        translation = truth_mean - rotation * estimate_mean
        ranked = sorted(pairs, key=lambda pair: abs(rotation * pair[0] + translation - pair[1]))
        kept = ranked[: max(2, len(pairs) * 4 // 5)]
    return rotation, translation


def errors_against_truth(poses):
    """(position error in m, yaw error in rad) of every (estimated pose, true pose)."""
    rotation, translation = align([(estimate[0], truth[0]) for estimate, truth in poses])
    turn = cmath.phase(rotation)
    return [
        (abs(rotation * estimate[0] + translation - truth[0]), abs(wrap(estimate[1] + turn - truth[1])))
        for estimate, truth in poses
    ]


def percentile(values, share):
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def show_progress(done, total, localized):
    line = f"   {done}/{total} frames sent, {localized} localized"
    if sys.stdout.isatty():
        print(f"\r{line}", end="\n" if done == total else "", flush=True)
    elif done % max(1, total // 10) == 0 or done == total:
        print(line, flush=True)


def drive(client, map_name, folder):
    """Sends every frame. Returns the pairs of estimated and true poses, and all latencies in ms."""
    frames, truth = read_frames(folder), read_truth(folder / "groundtruth.tum")
    poses, latencies_ms = [], []
    client.put_vehicle("demo", registration(map_name, folder))
    for number, (stamp, image_file) in enumerate(frames, start=1):
        image = image_file.read_bytes()
        start = time.perf_counter()
        answer = client.localize(map_name, image, vehicle="demo", stamp=stamp)
        latencies_ms.append(1000 * (time.perf_counter() - start))
        true_pose = truth_at(truth, float(stamp))
        if answer["status"] == "localized" and true_pose:
            pose = answer["pose"]
            poses.append(((complex(pose["x"], pose["y"]), pose["yaw"]), true_pose))
        show_progress(number, len(frames), len(poses))
    return poses, latencies_ms


def report(poses, latencies_ms):
    """Prints the summary; returns the share of frames that were localized correctly."""
    if len(poses) < 2:
        print(f"   {len(poses)} of {len(latencies_ms)} frames localized: nothing to compare")
        return 0.0
    errors = errors_against_truth(poses)
    right = [error for error in errors if error[0] <= MAX_ERROR_M and error[1] <= MAX_ERROR_RAD]
    positions_mm = [1000 * error[0] for error in errors]
    yaws_deg = [math.degrees(error[1]) for error in errors]
    total = len(latencies_ms)
    print(f"   success   {100 * len(right) / total:.1f} %  ({len(right)} of {total} frames within 10 mm and 1 degree;"
          f" {len(errors) - len(right)} wrong, {total - len(errors)} not localized)")
    print(f"   position  median {statistics.median(positions_mm):.2f} mm, 99 % {percentile(positions_mm, 0.99):.2f} mm")
    print(f"   heading   median {statistics.median(yaws_deg):.3f} deg, 99 % {percentile(yaws_deg, 0.99):.3f} deg")
    print(f"   latency   median {statistics.median(latencies_ms):.1f} ms, 99 % {percentile(latencies_ms, 0.99):.1f} ms"
          " (request to answer, whole map searched)")
    print("   The map's frame is that of its first survey frame, the truth's is the floor's corner: one rigid motion"
          "\n   between the two was fitted by least squares before the errors were measured.")
    return len(right) / total


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--server", default="http://127.0.0.1:8080")
    parser.add_argument("--map", required=True, help="name of the map on the server")
    parser.add_argument("--frames", required=True, type=pathlib.Path, help="folder in the survey format")
    arguments = parser.parse_args()
    try:
        with floorloc.Client(arguments.server, timeout_s=30.0) as client:
            client.wait_until_ready()
            success = report(*drive(client, arguments.map, arguments.frames))
    except (floorloc.FloorlocError, OSError, ValueError) as error:
        sys.exit(f"drive.py: {error}")
    if success < REQUIRED_SUCCESS:
        sys.exit(f"drive.py: only {100 * success:.1f} % of the frames were localized rightly,"
                 f" {100 * REQUIRED_SUCCESS:.0f} % are expected")


if __name__ == "__main__":
    main()
