#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Replays a recorded vehicle over HTTP, as a robot would: sends its odometry and images in the order in which they were
recorded; every response has the vehicle's pose and its uncertainty.

Needs a recording with odometry.tum, such as maps/sample/kidnap. Start it while a server runs:

    maps/vehicle.py --server http://127.0.0.1:8080 --map sample --frames maps/sample/kidnap --pace 1
"""

import argparse
import cmath
import csv
import dataclasses
import math
import pathlib
import statistics
import sys
import time

import drive
import floorloc  # found by drive

WRONG_M = 0.050
WRONG_RAD = math.radians(3.0)
REQUIRED_LOCALIZED = 0.80
STATES = ("localized", "tracking_odometry", "lost")


@dataclasses.dataclass
class Message:
    """A message of the robot: odometry since the previous message, or an image."""

    time_s: float
    stamp: str  # as written
    motion: tuple = None  # dx, dy, dyaw in the base frame at its start
    image_file: pathlib.Path = None


@dataclasses.dataclass
class Answer:
    """The server's response to a message."""

    time_s: float
    status: str
    pose: tuple  # position as a complex number, yaw; None when lost from the start
    latency_ms: float
    fix: dict  # for an image, else None


@dataclasses.dataclass
class Kidnap:
    """Detection of and recovery from a kidnap; times since the kidnap."""

    time_s: float
    noticed_s: float = None
    found_s: float = None
    frames: int = 0  # images until the vehicle was relocalized


def motion_between(before, after):
    """Motion in the base frame from one pose (complex position, yaw) to the next."""
    step = (after[0] - before[0]) * cmath.exp(-1j * before[1])
    return step.real, step.imag, drive.wrap(after[1] - before[1])


def read_messages(folder):
    """Odometry and images in order of time. Each image follows the odometry up to its time."""
    frames = [Message(float(stamp), stamp, image_file=image_file) for stamp, image_file in drive.read_frames(folder)]
    odometry = drive.read_truth(folder / "odometry.tum")
    times = sorted({round(time_s, 6) for time_s in odometry[0] + [frame.time_s for frame in frames]})
    poses = [(time_s, drive.truth_at(odometry, time_s)) for time_s in times]
    poses = [(time_s, pose) for time_s, pose in poses if pose]
    motions = [Message(after[0], f"{after[0]:.6f}", motion=motion_between(before[1], after[1]))
               for before, after in zip(poses, poses[1:])]
    return sorted(motions + frames, key=lambda message: (round(message.time_s, 6), message.image_file is not None))


def read_kidnaps(folder):
    file = folder / "events.csv"
    if not file.exists():
        return []
    with open(file, newline="") as rows:
        return [float(row["timestamp"]) for row in csv.DictReader(rows) if row["event"] == "kidnap"]


def send(client, vehicle, message):
    """Sends one message and returns the server's answer."""
    start = time.perf_counter()
    if message.image_file:
        said = client.post_frame(vehicle, message.image_file.read_bytes(), message.stamp)
    else:
        dx, dy, dyaw = message.motion
        said = client.post_odometry(vehicle, [{"stamp": message.stamp, "dx": dx, "dy": dy, "dyaw": dyaw}])
    latency_ms = 1000 * (time.perf_counter() - start)
    pose = said.get("pose")
    pose = (complex(pose["x"], pose["y"]), pose["yaw"]) if pose else None
    return Answer(message.time_s, said["status"], pose, latency_ms, said.get("fix"))


def narrate(answer, previous, start_s, kidnaps):
    """Prints changes of the vehicle's state."""
    for kidnap in kidnaps:
        if previous and previous.time_s < kidnap <= answer.time_s:
            print(f"   {kidnap - start_s:6.2f} s  kidnapped: lifted and put down elsewhere")
    if previous is None or answer.status != previous.status:
        reason = (answer.fix or {}).get("reject_reason") or ""
        moved = ""
        if previous and previous.pose and answer.pose and answer.status == "localized":
            jump_m = abs(answer.pose[0] - previous.pose[0])
            moved = f"found {jump_m:.2f} m from where odometry had it" if jump_m > WRONG_M else ""
        note = reason or moved
        print(f"   {answer.time_s - start_s:6.2f} s  {answer.status}{': ' + note if note else ''}", flush=True)


def run(client, arguments):
    """Sends the whole drive. Returns all answers."""
    messages = read_messages(arguments.frames)
    kidnaps = read_kidnaps(arguments.frames)
    client.delete_vehicle(arguments.vehicle)  # left by an earlier drive, if any
    client.put_vehicle(arguments.vehicle, drive.registration(arguments.map, arguments.frames))
    answers = []
    start_s, start = messages[0].time_s, time.monotonic()
    for message in messages:
        if arguments.pace > 0:
            time.sleep(max(0.0, start + (message.time_s - start_s) / arguments.pace - time.monotonic()))
        answer = send(client, arguments.vehicle, message)
        narrate(answer, answers[-1] if answers else None, start_s, kidnaps)
        answers.append(answer)
    return answers


def judge(answers, truth):
    """(answer, position error in m, yaw error in rad) of every answer with a pose, after alignment of the frames."""
    posed = [(answer, drive.truth_at(truth, answer.time_s)) for answer in answers if answer.pose]
    posed = [(answer, true_pose) for answer, true_pose in posed if true_pose]
    fixes = [(answer.pose[0], true[0]) for answer, true in posed if (answer.fix or {}).get("accepted")]
    if len(fixes) < 2:
        sys.exit("vehicle.py: fewer than two images were localized: nothing to compare with the truth")
    rotation, translation = drive.align(fixes)
    turn = cmath.phase(rotation)
    return [(answer, abs(rotation * answer.pose[0] + translation - true[0]),
             abs(drive.wrap(answer.pose[1] + turn - true[1]))) for answer, true in posed]


def is_wrong(position_m, yaw_rad):
    return position_m > WRONG_M or yaw_rad > WRONG_RAD


def follow_kidnap(time_s, until_s, judged):
    """Outcome of one kidnap, until the next."""
    kidnap = Kidnap(time_s)
    for answer, position_m, yaw_rad in judged:
        if not time_s <= answer.time_s < until_s:
            continue
        kidnap.frames += answer.fix is not None
        if answer.status != "localized":
            kidnap.noticed_s = kidnap.noticed_s or answer.time_s - time_s
        elif not is_wrong(position_m, yaw_rad):
            kidnap.found_s = answer.time_s - time_s
            break
    return kidnap


def follow_kidnaps(times_s, judged):
    ends_s = times_s[1:] + [math.inf]
    return [follow_kidnap(time_s, until_s, judged) for time_s, until_s in zip(times_s, ends_s)]


def print_kidnaps(kidnaps, start_s):
    for kidnap in kidnaps:
        when = f"   kidnap    at {kidnap.time_s - start_s:.2f} s: "
        if kidnap.found_s is None:
            print(when + "the vehicle was not found again")
        else:
            noticed = f"noticed after {kidnap.noticed_s:.2f} s, " if kidnap.noticed_s is not None else ""
            print(when + f"{noticed}found again after {kidnap.found_s:.2f} s and {kidnap.frames} frames")


def print_errors(name, errors):
    positions_mm = [1000 * position_m for position_m, _ in errors]
    yaws_deg = [math.degrees(yaw_rad) for _, yaw_rad in errors]
    wrong = sum(is_wrong(*error) for error in errors)
    print(f"   {name:9} position median {statistics.median(positions_mm):.2f} mm,"
          f" 90 % {drive.percentile(positions_mm, 0.9):.2f} mm; heading median {statistics.median(yaws_deg):.3f} deg,"
          f" 90 % {drive.percentile(yaws_deg, 0.9):.3f} deg; {wrong} of {len(errors)} wrong")
    return wrong


def report(answers, judged, kidnaps):
    """Prints the summary. Returns the problems found, as sentences."""
    good = [(answer.fix is not None, (position_m, yaw_rad))
            for answer, position_m, yaw_rad in judged if answer.status == "localized"]
    frames = [answer for answer in answers if answer.fix is not None]
    between = [answer for answer in answers if answer.fix is None]
    counts = ", ".join(f"{100 * sum(a.status == state for a in answers) / len(answers):.1f} % {state}"
                       for state in STATES)
    print(f"   answers   {len(answers)} to {len(frames)} images and {len(between)} of odometry: {counts}")
    wrong = print_errors("images", [errors for at_frame, errors in good if at_frame])
    print_errors("between", [errors for at_frame, errors in good if not at_frame])
    print_kidnaps(kidnaps, answers[0].time_s)
    for name, some in (("images", frames), ("odometry", between)):
        latencies_ms = [answer.latency_ms for answer in some]
        print(f"   latency   {name}: median {statistics.median(latencies_ms):.1f} ms,"
              f" 99 % {drive.percentile(latencies_ms, 0.99):.1f} ms")
    print("   Errors are those of poses called localized; wrong: beyond 50 mm or 3 degrees. A kidnap, or wheels"
          "\n   that slip, cannot be noticed before the next image.")
    return problems(wrong, len(good) / len(answers), kidnaps)


def problems(wrong, localized, kidnaps):
    found = []
    if wrong:
        found.append(f"{wrong} poses were called localized right after an image and are wrong")
    if localized < REQUIRED_LOCALIZED:
        found.append(f"only {100 * localized:.1f} % of the answers are localized,"
                     f" {100 * REQUIRED_LOCALIZED:.0f} % are expected")
    if any(kidnap.found_s is None for kidnap in kidnaps):
        found.append("a kidnapped vehicle was not found again")
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--server", default="http://127.0.0.1:8080")
    parser.add_argument("--map", required=True, help="name of the map on the server")
    parser.add_argument("--frames", required=True, type=pathlib.Path, help="recording in the survey format")
    parser.add_argument("--vehicle", default="demo-vehicle", help="name of the vehicle on the server")
    parser.add_argument("--pace", type=float, default=0.0, help="1: as fast as it was driven; 0: as fast as possible")
    arguments = parser.parse_args()
    try:
        with floorloc.Client(arguments.server, timeout_s=30.0) as client:
            client.wait_until_ready()
            answers = run(client, arguments)
    except (floorloc.FloorlocError, OSError, ValueError) as error:
        sys.exit(f"vehicle.py: {error}")
    dense = arguments.frames / "groundtruth_dense.tum"
    truth = drive.read_truth(dense if dense.exists() else arguments.frames / "groundtruth.tum")
    judged = judge(answers, truth)
    found = report(answers, judged, follow_kidnaps(read_kidnaps(arguments.frames), judged))
    if found:
        sys.exit("vehicle.py: " + "; ".join(found))


if __name__ == "__main__":
    main()
