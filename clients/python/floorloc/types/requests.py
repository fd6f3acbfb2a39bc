# SPDX-License-Identifier: Apache-2.0
"""What clients send: calibration, odometry, poses. Named as the schemas of schema/openapi.yaml."""

from __future__ import annotations

from typing import Any, Dict, List, Literal, TypedDict, Union


class Rectangle(TypedDict):
    x_min: float
    x_max: float
    y_min: float
    y_max: float


class _CameraRequired(TypedDict):
    image_width: int
    image_height: int
    camera_matrix: Union[List[float], Dict[str, Any]]
    distortion_model: Literal["plumb_bob", "rational_polynomial", "equidistant"]
    distortion_coefficients: Union[List[float], Dict[str, Any]]


class Camera(_CameraRequired, total=False):
    camera_name: str
    calibration_sigma: float
    readout_s: float
    readout_direction: Literal["down", "up", "right", "left"]
    stamp_at: Literal["start", "middle", "end"]


class _FloorRequired(TypedDict):
    homography: Union[List[float], Dict[str, Any]]
    roi: Rectangle
    resolution: float


class Floor(_FloorRequired, total=False):
    offset_sigma: float


class Gate(TypedDict, total=False):
    max_distance_m: float
    max_angle_rad: float


class _VehicleRequestRequired(TypedDict):
    map: str
    camera: Camera
    floor: Floor


class VehicleRequest(_VehicleRequestRequired, total=False):
    mask: str
    gate: Gate
    correct_camera: bool


class Motion(TypedDict):
    dx: float
    dy: float
    dyaw: float


class _IncrementRequired(TypedDict):
    stamp: Union[float, str]


class Increment(_IncrementRequired, total=False):
    odometry: Motion
    dx: float
    dy: float
    dyaw: float


class _InitialPoseRequired(TypedDict):
    x: float
    y: float
    yaw: float


class InitialPose(_InitialPoseRequired, total=False):
    covariance: List[float]
    stamp: Union[float, str]


class Twist(TypedDict):
    vx: float
    vy: float
    wz: float


class _CalibrationRequired(TypedDict):
    camera: Camera
    floor: Floor


class Calibration(_CalibrationRequired, total=False):
    """What a vehicle's images are understood by; mask: base64 of a PNG, black where the robot itself is in view."""

    mask: str
