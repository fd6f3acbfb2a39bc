#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A ROS 2 node that localizes a robot with a floorloc-server.

    subscribes   image/compressed  sensor_msgs/CompressedImage            JPEG or PNG of the floor camera
                 odom              nav_msgs/Odometry                      odom -> base_link, of the wheels
                 initialpose       geometry_msgs/PoseWithCovarianceStamped  RViz's "2D Pose Estimate"
    publishes    pose              geometry_msgs/PoseWithCovarianceStamped  map -> base_link, at the time of the message
                 /tf               map -> odom (REP-105), or map -> base_link without odometry, or nothing

    python3 floorloc_node.py --ros-args -p server:=http://localhost:8080 -p map:=hall -p vehicle:=agv7 \\
        -p calibration:=DIR

Parameters: PARAMETERS below. Tested without ROS: syntax, and the names and types of the fields that are set.
"""

import bisect
import collections
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "clients/python"))  # or pip install it
from floorloc import Client, FloorlocError, read_calibration, ros  # noqa: E402

try:
    import rclpy
    import tf2_ros
    from geometry_msgs.msg import PoseWithCovarianceStamped, TransformStamped
    from nav_msgs.msg import Odometry
    from rclpy.node import Node
    from rclpy.qos import qos_profile_sensor_data
    from sensor_msgs.msg import CompressedImage
except ImportError:  # the functions below are tested without ROS
    rclpy, Node = None, object

PARAMETERS = {
    "server": "http://127.0.0.1:8080",
    "token": "",
    "map": "",  # its name on the server
    "vehicle": "",  # the name of this robot there
    "calibration": "",  # folder with camera.yaml, floor.yaml and, where the robot sees itself, mask.png
    "map_frame": "map",
    "odom_frame": "odom",
    "base_frame": "base_link",
    "publish_tf": "map_odom",  # or map_base, for robots without odometry, or none, when a filter publishes it
    "transform_tolerance_s": 0.3,  # transforms are stamped so much later, as AMCL's, so that others need not wait
    "deadline_s": 0.3,  # for an answer
    "every_image": False,  # or those that the server wants
}
HISTORY_S = 10.0  # of odometry: poses that are answered are at most 5 s old


class OdometryHistory:
    """odom_from_base of the wheels, interpolated."""

    def __init__(self):
        self._stamps, self._poses = collections.deque(), collections.deque()

    def add(self, stamp_s, odom_from_base):
        """Returns the motion since the one before, base frame; None for the first, and for one that is not newer."""
        if self._stamps and stamp_s <= self._stamps[-1]:
            return None
        motion = self._poses[-1].inverse() * odom_from_base if self._poses else None
        self._stamps.append(stamp_s)
        self._poses.append(odom_from_base)
        while self._stamps[0] < stamp_s - HISTORY_S:
            self._stamps.popleft()
            self._poses.popleft()
        return motion

    def at(self, stamp_s):
        """None without odometry; the nearest beyond its ends."""
        if not self._stamps:
            return None
        after = bisect.bisect_left(self._stamps, stamp_s)
        if after in (0, len(self._stamps)):
            return self._poses[max(0, after - 1)]
        begin, end = self._poses[after - 1], self._poses[after]
        share = (stamp_s - self._stamps[after - 1]) / (self._stamps[after] - self._stamps[after - 1])
        step = begin.inverse() * end
        return begin * ros.Planar(*(share * value for value in step))


def make_transform(parameters, pose, history):
    """Fields of the TransformStamped to publish for an answer's pose; None when there is none to publish."""
    stamp = pose["stamp"] + parameters["transform_tolerance_s"]
    map_from_base = ros.planar(pose)
    if parameters["publish_tf"] == "map_base":
        return ros.transform_stamped(stamp, parameters["map_frame"], parameters["base_frame"], map_from_base)
    odom_from_base = history.at(pose["stamp"])
    if parameters["publish_tf"] != "map_odom" or odom_from_base is None:
        return None
    map_from_odom = map_from_base * odom_from_base.inverse()
    return ros.transform_stamped(stamp, parameters["map_frame"], parameters["odom_frame"], map_from_odom)


def read_initial_pose(message):
    """(x, y, yaw), and the covariance of them; None when the message has none."""
    full = [float(value) for value in message.pose.covariance]
    covariance = [full[6 * row + column] for row in ros.PLANAR for column in ros.PLANAR]
    pose = ros.planar_of_ros(message.pose.pose.position, message.pose.pose.orientation)
    return pose, covariance if all(covariance[4 * i] > 0.0 for i in range(3)) else None


class FloorlocNode(Node):
    """Callbacks run one after the other (rclpy.spin), so one client will do."""

    def __init__(self):
        super().__init__("floorloc")
        self.options = {name: self.declare_parameter(name, value).value for name, value in PARAMETERS.items()}
        self.client = Client(self.options["server"], token=self.options["token"] or None)
        self.vehicle = self.client.register(self.options["vehicle"], self.options["map"],
                                            **read_calibration(self.options["calibration"]))
        self.history = OdometryHistory()
        self.poses = self.create_publisher(PoseWithCovarianceStamped, "pose", 10)
        self.transforms = tf2_ros.TransformBroadcaster(self)
        self.create_subscription(Odometry, "odom", self.on_odometry, qos_profile_sensor_data)
        self.create_subscription(CompressedImage, "image/compressed", self.on_image, qos_profile_sensor_data)
        self.create_subscription(PoseWithCovarianceStamped, "initialpose", self.on_initial_pose, 1)

    def on_odometry(self, message):
        stamp = ros.seconds(message.header.stamp)
        pose = ros.planar_of_ros(message.pose.pose.position, message.pose.pose.orientation)
        motion = self.history.add(float(stamp), pose)
        if motion is not None:
            self.publish(lambda: self.vehicle.move(stamp, *motion, deadline_s=self.options["deadline_s"]))

    def on_image(self, message):
        stamp = ros.seconds(message.header.stamp)
        if self.options["every_image"] or self.vehicle.wants_frame(float(stamp)):
            image = bytes(message.data)
            self.publish(lambda: self.vehicle.frame(image, stamp, deadline_s=self.options["deadline_s"]))

    def on_initial_pose(self, message):
        pose, covariance = read_initial_pose(message)
        self.publish(lambda: self.vehicle.initial_pose(*pose, covariance))

    def publish(self, call):
        """Publishes the pose of a call's answer; a server that is away or busy does not stop the robot."""
        try:
            answer = call()
        except FloorlocError as error:
            self.get_logger().warning(str(error), throttle_duration_sec=5.0)
            return
        if answer is None or answer["status"] == "lost" or "pose" not in answer:
            return
        fields = ros.pose_with_covariance_stamped(answer["pose"], self.options["map_frame"])
        self.poses.publish(ros.fill(PoseWithCovarianceStamped(), fields))
        transform = make_transform(self.options, answer["pose"], self.history)
        if transform is not None:
            self.transforms.sendTransform(ros.fill(TransformStamped(), transform))


def main():
    if rclpy is None:
        sys.exit("floorloc_node.py: ROS 2 is missing; source its setup.bash first")
    rclpy.init()
    try:
        rclpy.spin(FloorlocNode())
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
