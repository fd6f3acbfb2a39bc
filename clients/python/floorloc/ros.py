# SPDX-License-Identifier: Apache-2.0
"""Poses in the field names of ROS 2 messages, and the transforms that a robot publishes. Needs no ROS."""

from __future__ import annotations

import decimal
import math
from typing import Any, Mapping, NamedTuple, Sequence, Union

from .types import Pose, RosHeader, RosPoseWithCovarianceStamped, RosQuaternion, RosTransformStamped, Transform

PLANAR = (0, 1, 5)  # x, y and yaw among x, y, z and the rotations about x, y, z


class Planar(NamedTuple):
    """target_from_source in the plane: metres, radians."""

    x: float
    y: float
    yaw: float

    def __mul__(self, other: "Planar") -> "Planar":  # type: ignore[override]
        """a_from_b * b_from_c = a_from_c."""
        cosine, sine = math.cos(self.yaw), math.sin(self.yaw)
        return Planar(self.x + cosine * other.x - sine * other.y, self.y + sine * other.x + cosine * other.y,
                      math.remainder(self.yaw + other.yaw, 2.0 * math.pi))

    def inverse(self) -> "Planar":
        cosine, sine = math.cos(self.yaw), math.sin(self.yaw)
        return Planar(-cosine * self.x - sine * self.y, sine * self.x - cosine * self.y, -self.yaw)


def planar(pose: Union[Pose, Transform]) -> Planar:
    return Planar(pose["x"], pose["y"], pose["yaw"])


def planar_of_ros(position: Any, orientation: Any) -> Planar:
    """Of the position and orientation of a ROS message; what is not in the plane is left out."""
    x, y, z, w = orientation.x, orientation.y, orientation.z, orientation.w
    return Planar(position.x, position.y, math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)))


def header(stamp: Union[int, float, str], frame_id: str) -> RosHeader:
    """std_msgs/Header. A string or Decimal of seconds keeps nanoseconds, a float some 200 ns."""
    total_ns = int((decimal.Decimal(str(stamp)) * 1_000_000_000).to_integral_value())
    sec, nanosec = divmod(total_ns, 1_000_000_000)
    return {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": frame_id}  # type: ignore[typeddict-item]


def seconds(stamp: Any) -> str:
    """Of a builtin_interfaces/Time, with all digits, as the calls take it."""
    return f"{stamp.sec}.{stamp.nanosec:09d}"


def quaternion(yaw: float) -> RosQuaternion:
    return {"x": 0.0, "y": 0.0, "z": math.sin(yaw / 2.0), "w": math.cos(yaw / 2.0)}


def covariance(of_planar: Sequence[float]) -> Sequence[float]:
    """36 numbers of 9. z and the rotations about x and y are 0 by definition, and so are their variances, as in what
    AMCL publishes: leave them out of a filter (robot_localization: false in pose0_config)."""
    full = [0.0] * 36
    for row in range(3):
        for column in range(3):
            full[6 * PLANAR[row] + PLANAR[column]] = float(of_planar[3 * row + column])
    return full


def pose_with_covariance_stamped(pose: Pose, frame_id: str = "map") -> RosPoseWithCovarianceStamped:
    """geometry_msgs/PoseWithCovarianceStamped of an answer's pose."""
    return {"header": header(pose["stamp"], frame_id),
            "pose": {"pose": {"position": {"x": float(pose["x"]), "y": float(pose["y"]), "z": 0.0},
                              "orientation": quaternion(pose["yaw"])},
                     "covariance": list(covariance(pose["covariance"]))}}


def transform_stamped(stamp: Union[int, float, str], frame_id: str, child_frame_id: str,
                      transform: Planar) -> RosTransformStamped:
    """geometry_msgs/TransformStamped of frame_id_from_child."""
    return {"header": header(stamp, frame_id), "child_frame_id": child_frame_id,  # type: ignore[typeddict-item]
            "transform": {"translation": {"x": float(transform.x), "y": float(transform.y), "z": 0.0},
                          "rotation": quaternion(transform.yaw)}}


def fill(message: Any, fields: Mapping[str, Any]) -> Any:
    """Sets the fields of a ROS message, nested ones too; returns it. Raises AttributeError for one that it has not."""
    for name, value in fields.items():
        before = getattr(message, name)
        setattr(message, name, fill(before, value) if isinstance(value, Mapping) else value)
    return message
