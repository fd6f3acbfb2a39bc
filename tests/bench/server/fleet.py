# SPDX-License-Identifier: Apache-2.0
"""The requests of simulated vehicles: all drive a recorded drive to its end, back, and so on."""

import cmath
import http.client
import itertools
import json
import math
import pathlib
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).parents[3] / "maps"))
import drive  # noqa: E402

START_S = time.time()


def request(method, target, deadline_ms=None, **body):
    """A request of a load plan (load_plan.h)."""
    kind = {"body": "image/jpeg", "text": "application/json"}
    headers = "".join(f"Content-Type: {kind[key]}\r\n" for key in body)
    if deadline_ms is not None:
        headers += f"X-Deadline-Ms: {deadline_ms}\r\n"
    return {"head": f"{method} {target} HTTP/1.1\r\n{headers}", **body}


def address(number):
    """A loopback address per client."""
    return f"127.1.{number // 250}.{number % 250 + 1}"


class Fleet:
    """Vehicles on one map of a running server, all with the camera of a recorded drive."""

    def __init__(self, port, map_name, folder):
        self.map = map_name
        self.registration = json.dumps(drive.registration(map_name, folder))
        self.connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
        self.register("bench")
        self.images, self.poses = [], []
        for stamp, image in drive.read_frames(folder):
            answer = self.call("POST", f"/v1/maps/{map_name}/localize?vehicle=bench&stamp={stamp}", image.read_bytes(),
                               "image/jpeg")
            if answer["status"] == "localized":
                pose = answer["pose"]
                self.images.append(str(image))
                self.poses.append((complex(pose["x"], pose["y"]), pose["yaw"]))
        if len(self.images) < 2:
            raise RuntimeError(f"no frames of {folder} are found in the map")

    def call(self, method, target, body=None, content_type="application/json"):
        self.connection.request(method, target, body, {"Content-Type": content_type} if body else {})
        response = self.connection.getresponse()
        content = response.read()
        if response.status >= 400:
            raise RuntimeError(f"{method} {target}: {response.status} {content.decode(errors='replace')}")
        return json.loads(content or b"{}")

    def register(self, vehicle):
        self.call("PUT", f"/v1/vehicles/{vehicle}", self.registration)

    def register_many(self, count, prefix="v"):
        names = [f"{prefix}{number}" for number in range(count)]
        for name in names:
            self.register(name)
        return names

    def localize(self, prior, deadline_ms=None):
        """Requests for every frame once, stateless, with a prior 2 cm off or without any."""
        for index, (position, yaw) in enumerate(self.poses):
            near = position + 0.02 * cmath.exp(1j * index)
            query = f"&prior={near.real:.4f},{near.imag:.4f},{yaw:.4f}" if prior else ""
            yield request("POST", f"/v1/maps/{self.map}/localize?vehicle=bench{query}", deadline_ms, body=index)

    def way(self, start):
        """Indices of frames, to the end and back for ever."""
        count = len(self.images)
        for step in itertools.count(start % (2 * count - 2)):
            yield count - 1 - abs(count - 1 - step % (2 * count - 2))

    def motion(self, before, after):
        """dx, dy, dyaw in the base frame."""
        (position_a, yaw_a), (position_b, yaw_b) = self.poses[before], self.poses[after]
        step = (position_b - position_a) * cmath.exp(-1j * yaw_a)
        return step.real, step.imag, math.remainder(yaw_b - yaw_a, 2 * math.pi)

    def frames(self, vehicle, start, count, interval_s, deadline_ms=None):
        """Images with odometry."""
        way = self.way(start)
        last = next(way)
        for number in range(count):
            index = next(way)
            motion = ",".join(f"{value:.5f}" for value in self.motion(last, index))
            last = index
            yield request("POST", f"/v1/vehicles/{vehicle}/frames?stamp={START_S + number * interval_s:.3f}"
                                  f"&odometry={motion}", deadline_ms, body=index)

    def odometry(self, vehicle, start, count, interval_s):
        way = self.way(start)
        last = next(way)
        for number in range(1, count + 1):
            index = next(way)
            dx, dy, dyaw = self.motion(last, index)
            last = index
            yield request("POST", f"/v1/vehicles/{vehicle}/odometry",
                          text=json.dumps({"stamp": round(START_S + number * interval_s, 3), "dx": round(dx, 5),
                                           "dy": round(dy, 5), "dyaw": round(dyaw, 5)}))

    def driving(self, vehicle, start, seconds, odometry_hz, frame_every_s, begin_s=0.0):
        """Odometry, and now and then an image at its time in place of an increment."""
        way = self.way(start)
        last = next(way)
        for number in range(1, int(seconds * odometry_hz) + 1):
            index = next(way)
            motion = self.motion(last, index)
            last = index
            stamp = START_S + begin_s + number / odometry_hz
            if (number + start) % int(frame_every_s * odometry_hz) == 0:
                values = ",".join(f"{value:.5f}" for value in motion)
                yield request("POST", f"/v1/vehicles/{vehicle}/frames?stamp={stamp:.3f}&odometry={values}", body=index)
            else:
                yield request("POST", f"/v1/vehicles/{vehicle}/odometry",
                              text=json.dumps({"stamp": round(stamp, 3), "dx": round(motion[0], 5),
                                               "dy": round(motion[1], 5), "dyaw": round(motion[2], 5)}))
