#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The Python client against the real server; every answer is checked against schema/openapi.yaml.
Arguments: floorloc-mapbuilder, floorloc-server."""

import json
import math
import pathlib
import subprocess
import sys
import tempfile
import threading
import unittest

import openapi
import real_server

import floorloc
from floorloc import Client, FloorlocError, read_calibration, ros

MAPBUILDER, SERVER = sys.argv[1:3]
del sys.argv[1:3]
TOKEN = "0123456789abcdef"


class ServerTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="floorloc-clients-")))
        cls.maps = real_server.build_map(MAPBUILDER, cls.folder)
        cls.server = real_server.RealServer(SERVER, cls.maps)
        cls.addClassCleanup(lambda: cls.server.stop())
        cls.frames = [(stamp, file.read_bytes()) for stamp, file in real_server.frames()]
        cls.calibration = read_calibration(real_server.SURVEY)

    def setUp(self):
        self.client = self.enterContext(Client(self.server.url))

    def assert_fits(self, schema, answer):
        self.assertEqual(openapi.misfits(openapi.SCHEMAS[schema], answer), [], schema)

    def register(self, name):
        vehicle = self.client.register(name, "hall", **self.calibration)
        self.addCleanup(vehicle.remove)
        return vehicle

    def test_the_example_of_the_readme(self):
        text = (real_server.ROOT / "clients/python/README.md").read_text(encoding="utf-8")
        example = text.split("```python\n")[1].split("```")[0]
        self.assertIn(example, (real_server.ROOT / "README.md").read_text(encoding="utf-8"))
        example = example.replace("http://localhost:8080", self.server.url)
        example = example.replace('"SURVEY"', repr(str(real_server.SURVEY)))
        example = example.replace('"frame.jpg"', repr(str(real_server.frames()[3][1])))
        printed = subprocess.run([sys.executable, "-W", "ignore", "-c", example], capture_output=True, text=True,
                                 check=True, env={"PYTHONPATH": str(real_server.ROOT / "clients/python")}).stdout
        self.assertTrue(printed.startswith("localized {"), printed)
        self.client.delete_vehicle("agv7")

    def test_one_image_by_vehicle_by_calibration_and_near_a_prior(self):
        self.register("a")
        stamp, image = self.frames[5]
        by_vehicle = self.client.localize("hall", image, vehicle="a", stamp=stamp)
        self.assert_fits("LocalizeAnswer", by_vehicle)
        self.assertEqual((by_vehicle["status"], by_vehicle["fix"]["search"]), ("localized", "global"))
        pose = by_vehicle["pose"]
        self.assertEqual(pose["stamp"], float(stamp))
        prior = (pose["x"], pose["y"], pose["yaw"])
        for options in ({"vehicle": "a"}, {"calibration": self.calibration}):
            answer = self.client.localize("hall", image, prior=prior, radius=0.2, twist=(0.1, 0, 0), deadline_s=5,
                                          **options)
            self.assertEqual(answer["fix"]["search"], "prior")
            self.assertAlmostEqual(answer["pose"]["x"], pose["x"], delta=0.001)

    def test_a_drive_with_odometry(self):
        vehicle = self.register("b")
        self.assertTrue(vehicle.wants_frame())
        answer = vehicle.frame(self.frames[4][1], 100.0)
        self.assert_fits("FrameAnswer", answer)
        self.assertTrue(answer["fix"]["accepted"], answer)
        self.assertFalse(vehicle.wants_frame(100.0))
        before = ros.planar(answer["pose"])
        for i in range(1, 14):
            moved = vehicle.move(100 + 0.02 * i, 0.01, 0.0, 0.0)
        self.assertIsNone(moved)
        answer = vehicle.flush()
        self.assert_fits("OdometryAnswer", answer)
        self.assertEqual(set(answer["messages"]), {"used"})
        step = before.inverse() * ros.planar(answer["pose"])
        self.assertAlmostEqual(step.x, 0.13, delta=0.005)
        again = self.client.post_odometry("b", [{"stamp": 100.26, "dx": 0.01, "dy": 0.0, "dyaw": 0.0}])
        self.assertEqual(again["message"], "duplicate", "sent twice, it counts once")
        covariance = [0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01]
        self.assert_fits("TrackingAnswer", vehicle.initial_pose(1.0, 0.5, 0.25, covariance))
        info = vehicle.info()
        self.assert_fits("Vehicle", info)
        self.assertEqual((round(info["pose"]["x"], 6), info["messages"]["duplicate"]), (1.0, 1))
        self.assert_fits("Diagnosis", self.client.get_diagnosis("b"))
        self.assert_fits("LastFrame", self.client.get_last_frame("b"))

    def test_poses_for_ros_are_those_that_the_client_makes(self):
        vehicle = self.register("c")
        self.assertIsNone(vehicle.ros()["pose"])
        self.assert_fits("RosVehicle", vehicle.ros())
        answer = vehicle.frame(self.frames[2][1], "1700000000.123456789")
        said = vehicle.ros()
        self.assert_fits("RosVehicle", said)
        self.assertEqual(said["pose"]["header"]["stamp"], {"sec": 1700000000, "nanosec": 123456789})
        made = ros.pose_with_covariance_stamped({**answer["pose"], "stamp": "1700000000.123456789"})
        self.assert_almost_same(said["pose"], made)
        made = ros.transform_stamped("1700000000.123456789", "map", "base_link", ros.planar(answer["pose"]))
        self.assert_almost_same(said["map_from_base"], made)

    def assert_almost_same(self, said, made):
        if isinstance(said, dict):
            self.assertEqual(set(said), set(made))
            for name in said:
                self.assert_almost_same(said[name], made[name])
        elif isinstance(said, list):
            self.assertEqual(len(said), len(made))
            for one, other in zip(said, made):
                self.assert_almost_same(one, other)
        elif isinstance(said, float):
            self.assertTrue(math.isclose(said, made, rel_tol=1e-9, abs_tol=1e-12), (said, made))
        else:
            self.assertEqual(said, made)

    def test_maps_vehicles_and_fixes(self):
        vehicle = self.register("d")
        vehicle.frame(self.frames[1][1], 1.0)
        self.assert_fits("MapList", self.client.list_maps())
        self.assert_fits("Map", self.client.get_map("hall"))
        self.assert_fits("VehicleList", self.client.list_vehicles())
        self.assert_fits("FixList", self.client.list_fixes("hall"))
        self.assert_fits("MapSuccess", self.client.get_success("hall"))
        self.assertTrue(self.client.call("GET", "/v1/maps/hall/tiles/0/0/0.jpg").startswith(b"\xff\xd8"))
        self.assertIn(b"openapi: 3.1", self.client.call("GET", "/openapi.yaml"))
        with self.assertRaises(FloorlocError) as caught:
            self.client.get_map("cellar")
        self.assertEqual((caught.exception.status, caught.exception.reason), (404, "unknown_map"))
        self.assertTrue(caught.exception.detail.endswith("."))

    def test_calls_and_events_survive_a_restart_of_the_server(self):
        vehicle = self.register("e")
        stamps, stop = [], threading.Event()

        def drive():
            while not stop.wait(0.05):
                try:
                    answer = vehicle.frame(self.frames[4][1], float(len(stamps)))
                except FloorlocError as error:  # at the moment of the restart
                    self.assertEqual(error.reason, "unreachable")
                    continue
                stamps.append(answer["pose"]["stamp"])

        driving = threading.Thread(target=drive)
        driving.start()
        self.addCleanup(driving.join)
        self.addCleanup(stop.set)
        events = self.client.stream_events(vehicle="e", types=["fix"], patience_s=20)
        self.addCleanup(events.close)
        first = next(events)
        self.assertEqual((first.type, first.data["vehicle"]), ("fix", "e"))
        self.server.stop()
        before = len(stamps)
        self.server.start()
        second = next(event for event in events if event.data.get("stamp", -1) > before)
        self.assertGreater(int(second.id), int(first.id))

    def test_a_deadline_that_cannot_be_kept_is_refused_by_client_or_server(self):
        self.register("f")
        with self.assertRaises(FloorlocError) as caught:
            self.client.localize("hall", self.frames[0][1], vehicle="f", deadline_s=0.0001)
        self.assertIn(caught.exception.reason, ("deadline_exceeded", "deadline"))

    def test_tokens_and_the_rate_limit(self):
        token_file = self.folder / "token"
        token_file.write_text(TOKEN)
        token_file.chmod(0o600)
        config = self.folder / "config.json"
        config.write_text(json.dumps({"token_file": str(token_file), "protect_reads": True, "read_only": True,
                                      "limits": {"max_requests_per_s": 2}}))
        server = real_server.RealServer(SERVER, self.maps, config)
        self.addCleanup(server.stop)
        with Client(server.url) as stranger, self.assertRaises(FloorlocError) as caught:
            stranger.list_maps()
        self.assertEqual((caught.exception.status, caught.exception.reason), (401, "unauthorized"))
        impatient = self.enterContext(Client(server.url, token=TOKEN, retry=floorloc.Retry(attempts=1)))
        with self.assertRaises(FloorlocError) as caught:
            for _ in range(10):
                impatient.list_maps()
        self.assertEqual((caught.exception.status, caught.exception.reason), (429, "rate_limited"))
        self.assertGreaterEqual(caught.exception.retry_after_s, 1)
        self.assert_fits("MapList", self.enterContext(Client(server.url, token=TOKEN)).list_maps())


if __name__ == "__main__":
    unittest.main()
