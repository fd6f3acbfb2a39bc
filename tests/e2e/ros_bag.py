# SPDX-License-Identifier: Apache-2.0
"""Writes a survey folder as a bag of rosbag2 (SQLite). The messages are made here by hand; the readers are tested with
bags of others' libraries in tests/mapbuilder/bag."""

import math
import re
import sqlite3
import struct
from pathlib import Path


class Cdr:
    """A message of ROS 2: little-endian, aligned from behind the encapsulation header."""

    def __init__(self):
        self.body = b""

    def number(self, code, *values):
        size = struct.calcsize(code)
        for value in values:
            self.body += b"\0" * (-len(self.body) % size) + struct.pack("<" + code, value)
        return self

    def text(self, value):
        data = value.encode() + b"\0"
        self.number("I", len(data))
        self.body += data
        return self

    def data(self, value):
        self.number("I", len(value))
        self.body += value
        return self

    def header(self, stamp_ns, frame):
        self.number("i", stamp_ns // 10**9).number("I", stamp_ns % 10**9)
        return self.text(frame)

    def bytes(self):
        return b"\0\1\0\0" + self.body


def nanoseconds(text):
    whole, _, fraction = text.partition(".")
    return int(whole) * 10**9 + int(fraction.ljust(9, "0"))


def numbers(text, key):
    return [float(value) for value in re.search(key + r":[^\[]*\[([^\]]*)\]", text).group(1).split(",")]


def inverse(m):
    a, b, c, d, e, f, g, h, i = m
    det = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    return [v / det for v in [e * i - f * h, c * h - b * i, b * f - c * e, f * g - d * i, a * i - c * g, c * d - a * f,
                              d * h - e * g, b * g - a * h, a * e - b * d]]


def product(m, n):
    return [sum(m[3 * row + k] * n[3 * k + column] for k in range(3)) for row in range(3) for column in range(3)]


def camera_pose(k, base_from_pixel):
    """Translation and quaternion (x, y, z, w) of base_from_camera: Zhang 2000."""
    m = product(inverse(k), inverse(base_from_pixel))
    scale = math.sqrt(m[0] ** 2 + m[3] ** 2 + m[6] ** 2) * (1 if m[8] > 0 else -1)
    r1, r2, t = ([m[column + 3 * row] / scale for row in range(3)] for column in range(3))
    r3 = [r1[1] * r2[2] - r1[2] * r2[1], r1[2] * r2[0] - r1[0] * r2[2], r1[0] * r2[1] - r1[1] * r2[0]]
    rotation = r1 + r2 + r3  # rows: of base_from_camera
    place = [-sum(rotation[3 * row + i] * t[i] for i in range(3)) for row in range(3)]
    w = math.sqrt(max(0.0, 1 + rotation[0] + rotation[4] + rotation[8])) / 2
    x, y, z = (math.copysign(math.sqrt(max(0.0, 1 + s)) / 2, d) for s, d in [
        (rotation[0] - rotation[4] - rotation[8], rotation[7] - rotation[5]),
        (-rotation[0] + rotation[4] - rotation[8], rotation[2] - rotation[6]),
        (-rotation[0] - rotation[4] + rotation[8], rotation[3] - rotation[1])])
    return place, [x, y, z, w]


def camera_info(survey, stamp_ns):
    text = (survey / "camera.yaml").read_text()
    size = [int(re.search(rf"image_{side}: (\d+)", text).group(1)) for side in ["height", "width"]]
    k, d = numbers(text, "camera_matrix"), numbers(text, "distortion_coefficients")
    message = Cdr().header(stamp_ns, "camera_optical").number("I", *size)
    message.text(re.search(r"distortion_model: (\w+)", text).group(1)).number("I", len(d)).number("d", *d, *k)
    message.number("d", 1, 0, 0, 0, 1, 0, 0, 0, 1, *k[:3], 0, *k[3:6], 0, *k[6:], 0)
    return message.number("I", 0, 0, 0, 0, 0, 0).number("B", 0).bytes()


def transforms(survey, stamp_ns):
    k = numbers((survey / "camera.yaml").read_text(), "camera_matrix")
    place, rotation = camera_pose(k, numbers((survey / "floor.yaml").read_text(), "homography"))
    message = Cdr().number("I", 1).header(stamp_ns, "base_link").text("camera_optical")
    return message.number("d", *place, *rotation).bytes()


def odometry(row, stamp_ns):
    message = Cdr().header(stamp_ns, "odom").text("base_link").number("d", *map(float, row[1:]))
    return message.number("d", *[0.0] * (36 + 6 + 36)).bytes()


def write_bag(survey, file, with_mounting=True, image_stamp=lambda number, stamp_ns: stamp_ns):
    """Images, calibration, mounting and odometry of a survey folder. image_stamp: of the header of an image, by its number
    and the time of recording."""
    survey = Path(survey)
    frames = [line.split(",") for line in (survey / "frames.csv").read_text().split()[1:]]
    start = nanoseconds(frames[0][0])
    messages = [("/camera/camera_info", "sensor_msgs/msg/CameraInfo", start, camera_info(survey, start))]
    if with_mounting:
        messages.append(("/tf_static", "tf2_msgs/msg/TFMessage", start, transforms(survey, start)))
    for number, (stamp, name) in enumerate(frames):
        image = Cdr().header(image_stamp(number, nanoseconds(stamp)), "camera_optical").text("jpeg").data((survey / name).read_bytes())
        messages.append(("/camera/image_raw/compressed", "sensor_msgs/msg/CompressedImage", nanoseconds(stamp), image.bytes()))
    for line in (survey / "odometry.tum").read_text().splitlines():
        row = line.split()
        messages.append(("/odom", "nav_msgs/msg/Odometry", nanoseconds(row[0]), odometry(row, nanoseconds(row[0]))))
    messages.sort(key=lambda message: message[2])
    db = sqlite3.connect(file)
    db.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT)")
    db.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)")
    ids = {}
    for topic, kind, stamp_ns, data in messages:
        if topic not in ids:
            ids[topic] = len(ids) + 1
            db.execute("INSERT INTO topics VALUES (?, ?, ?, 'cdr')", [ids[topic], topic, kind])
        db.execute("INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)", [ids[topic], stamp_ns, data])
    db.commit()
    db.close()
