# SPDX-License-Identifier: Apache-2.0
"""Fields of ROS 2 messages, as format=ros has them."""

from __future__ import annotations

from typing import List, Literal, Optional, TypedDict


class RosTime(TypedDict):
    sec: int
    nanosec: int


class RosHeader(TypedDict):
    stamp: RosTime
    frame_id: Literal["map", "odom"]


class RosVector3(TypedDict):
    x: float
    y: float
    z: float


class RosQuaternion(TypedDict):
    x: float
    y: float
    z: float
    w: float


class RosPose(TypedDict):
    position: RosVector3
    orientation: RosQuaternion


class RosPoseWithCovariance(TypedDict):
    pose: RosPose
    covariance: List[float]


class RosPoseWithCovarianceStamped(TypedDict):
    header: RosHeader
    pose: RosPoseWithCovariance


class RosTransform(TypedDict):
    translation: RosVector3
    rotation: RosQuaternion


class RosTransformStamped(TypedDict):
    header: RosHeader
    child_frame_id: Literal["odom", "base_link"]
    transform: RosTransform


class _RosVehicleRequired(TypedDict):
    id: str
    map: str
    status: Literal["localized", "tracking_odometry", "lost", "stale"]
    epoch: int
    silent_s: float
    pose: Optional[RosPoseWithCovarianceStamped]
    map_from_base: Optional[RosTransformStamped]
    map_from_odom: Optional[RosTransformStamped]
    odom_from_base: Optional[RosTransformStamped]


class RosVehicle(_RosVehicleRequired, total=False):
    lost_reason: Literal["map_changed"]
