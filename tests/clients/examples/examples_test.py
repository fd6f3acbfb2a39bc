#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The examples against the real server, and the ROS 2 node without ROS: the fields that it sets, the parameter files.
Arguments: floorloc-mapbuilder, floorloc-server, floorloc_robot_loop."""

import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

import yaml

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "python"))
import real_server  # noqa: E402

sys.path.insert(0, str(real_server.ROOT / "examples/ros2"))
import floorloc_node  # noqa: E402
import ros_messages  # noqa: E402
from floorloc import read_calibration, ros  # noqa: E402

MAPBUILDER, SERVER, ROBOT_LOOP = sys.argv[1:4]
del sys.argv[1:4]
EXAMPLES = real_server.ROOT / "examples"


class ProgramsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="floorloc-examples-")))
        cls.server = real_server.RealServer(SERVER, real_server.build_map(MAPBUILDER, cls.folder))
        cls.addClassCleanup(cls.server.stop)
        cls.drive = cls.folder / "survey"  # the surveyed frames, with their odometry

    def output(self, *command):
        result = subprocess.run([*map(str, command)], capture_output=True, text=True, timeout=60)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout, result.stderr

    def test_calls_with_curl(self):
        said, _ = self.output("bash", EXAMPLES / "calls.sh", self.server.url, "hall", self.drive)
        answers = [json.loads(line) for line in said.splitlines() if line.startswith("{")]
        self.assertEqual(len(answers), 5)
        self.assertEqual([answers[i]["status"] for i in (1, 2)], ["localized", "localized"])
        self.assertEqual(answers[3]["messages"], ["used"])
        self.assertEqual(answers[4]["pose"]["header"]["frame_id"], "map")

    def check_loop(self, said):
        lines = [line.split() for line in said.splitlines()]
        self.assertGreaterEqual(len(lines), 3)
        self.assertTrue(all(status == "localized" for _, status, *_ in lines), said)

    def test_robot_loop_in_python(self):
        said, _ = self.output(sys.executable, EXAMPLES / "robot_loop.py", "--server", self.server.url, "--map", "hall",
                              "--drive", self.drive)
        self.check_loop(said)

    def test_robot_loop_in_cpp(self):
        vehicle = self.folder / "vehicle.json"
        vehicle.write_text(json.dumps(read_calibration(self.drive)))
        said, _ = self.output(ROBOT_LOOP, self.server.url, "hall", vehicle, self.drive)
        self.check_loop(said)


POSE = {"map": "hall", "map_version": "v", "frame": "map", "stamp": 100.25, "x": 1.0, "y": 2.0, "yaw": 0.5,
        "covariance": [1e-8, 2e-9, 3e-9, 2e-9, 4e-8, 5e-9, 3e-9, 5e-9, 6e-7]}


class RosNodeTest(unittest.TestCase):
    def setUp(self):
        self.history = floorloc_node.OdometryHistory()
        self.parameters = dict(floorloc_node.PARAMETERS)

    def test_the_pose_fits_its_message(self):
        message = ros.fill(ros_messages.PoseWithCovarianceStamped(), ros.pose_with_covariance_stamped(POSE))
        self.assertEqual((message.header.stamp.sec, message.header.stamp.nanosec, message.header.frame_id),
                         (100, 250000000, "map"))
        self.assertEqual(message.pose.covariance[35], 6e-7)
        self.assertEqual(ros.planar_of_ros(message.pose.pose.position, message.pose.pose.orientation)[:2], (1.0, 2.0))
        with self.assertRaises(AttributeError):
            ros.fill(message, {"heading": 1.0})

    def test_map_from_odom_takes_the_wheels_pose_of_that_time(self):
        for i in range(5):
            self.history.add(100 + 0.1 * i, ros.Planar(0.3 * i, 0.0, 0.1 * i))
        message = ros.fill(ros_messages.TransformStamped(),
                           floorloc_node.make_transform(self.parameters, POSE, self.history))
        self.assertEqual((message.header.frame_id, message.child_frame_id), ("map", "odom"))
        self.assertEqual((message.header.stamp.sec, message.header.stamp.nanosec), (100, 550000000))
        made = ros.planar_of_ros(message.transform.translation, message.transform.rotation) * self.history.at(100.25)
        for value, expected in zip(made, (1.0, 2.0, 0.5)):
            self.assertAlmostEqual(value, expected)
        self.assertAlmostEqual(self.history.at(100.25).x, 0.75, places=2)

    def test_other_transforms_on_request(self):
        self.assertIsNone(floorloc_node.make_transform(self.parameters, POSE, self.history), "no odometry yet")
        self.parameters["publish_tf"] = "map_base"
        made = floorloc_node.make_transform(self.parameters, POSE, self.history)
        self.assertEqual((made["child_frame_id"], made["transform"]["translation"]["x"]), ("base_link", 1.0))
        self.parameters["publish_tf"] = "none"
        self.history.add(1.0, ros.Planar(0, 0, 0))
        self.assertIsNone(floorloc_node.make_transform(self.parameters, POSE, self.history))

    def test_odometry_becomes_motions_and_old_poses_are_forgotten(self):
        self.assertIsNone(self.history.add(1.0, ros.Planar(1.0, 1.0, math.pi / 2)))
        motion = self.history.add(1.1, ros.Planar(1.0, 1.5, math.pi / 2))
        for value, expected in zip(motion, (0.5, 0.0, 0.0)):
            self.assertAlmostEqual(value, expected)
        self.assertIsNone(self.history.add(1.1, ros.Planar(9.0, 9.0, 0.0)), "not newer")
        self.history.add(100.0, ros.Planar(2.0, 2.0, 0.0))
        self.assertEqual(self.history.at(1.0), ros.Planar(2.0, 2.0, 0.0))

    def test_an_initial_pose_brings_its_covariance_when_it_has_one(self):
        message = ros.fill(ros_messages.PoseWithCovarianceStamped(), ros.pose_with_covariance_stamped(POSE))
        pose, covariance = floorloc_node.read_initial_pose(message)
        self.assertAlmostEqual(pose.yaw, 0.5)
        self.assertEqual(covariance, POSE["covariance"])
        message.pose.covariance = [0.0] * 36
        self.assertIsNone(floorloc_node.read_initial_pose(message)[1])

    def test_without_ros_it_says_so(self):
        result = subprocess.run([sys.executable, EXAMPLES / "ros2/floorloc_node.py"], capture_output=True, text=True)
        if floorloc_node.rclpy is None:
            self.assertEqual((result.returncode, "ROS 2 is missing" in result.stderr), (1, True))

    def test_parameter_files_agree_with_the_node(self):
        ekf = yaml.safe_load((EXAMPLES / "ros2/ekf.yaml").read_text(encoding="utf-8"))
        frames = {name: self.parameters[name] for name in ("map_frame", "odom_frame")}
        for node in ekf.values():
            options = node["ros__parameters"]
            self.assertEqual({name: options[name] for name in frames}, frames)
            self.assertEqual(options["base_link_frame"], self.parameters["base_frame"])
            for name, value in options.items():
                if name.endswith("_config"):
                    self.assertTrue(len(value) == 15 and all(isinstance(one, bool) for one in value), name)
        fused = ekf["ekf_map"]["ros__parameters"]["pose0_config"]
        self.assertEqual([i for i, used in enumerate(fused) if used], list(ros.PLANAR))
        nav2 = yaml.safe_load((EXAMPLES / "ros2/nav2.yaml").read_text(encoding="utf-8"))
        self.assertEqual(nav2["bt_navigator"]["ros__parameters"]["global_frame"], self.parameters["map_frame"])
        self.assertEqual(nav2["local_costmap"]["local_costmap"]["ros__parameters"]["global_frame"],
                         self.parameters["odom_frame"])


if __name__ == "__main__":
    unittest.main()
