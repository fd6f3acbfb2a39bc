# SPDX-License-Identifier: Apache-2.0
"""Vehicles. Named as the schemas of schema/openapi.yaml."""

from __future__ import annotations

from typing import Any, Dict, List, Literal, Optional, TypedDict, Union

from .answers import Alternative, CameraCorrection, FixRecord, OdometryTrust, Pose, SinceFix
from .requests import Floor, Gate


class CameraMounting(TypedDict):
    roll: float
    pitch: float
    height_share: float


class CameraEstimate(TypedDict):
    status: Literal["learning", "as_calibrated", "corrected", "implausible"]
    fixes: int
    off_px: float
    roll: float
    pitch: float
    height_share: float
    sigma: CameraMounting
    readout_s: Optional[float]
    readout_sigma_s: Optional[float]


class MaskSummary(TypedDict):
    masked_share: float
    of: Literal["vehicle", "map"]


class _VehicleCameraRequired(TypedDict):
    image_width: int
    image_height: int
    camera_matrix: Union[List[float], Dict[str, Any]]
    distortion_model: Literal["plumb_bob", "rational_polynomial", "equidistant"]
    distortion_coefficients: Union[List[float], Dict[str, Any]]
    masked_share: float
    masked_by: List[Literal["registration", "map", "learnt"]]
    learnt_mask: Dict[str, Any]


class VehicleCamera(_VehicleCameraRequired, total=False):
    camera_name: str
    calibration_sigma: float


class MessageCounts(TypedDict):
    used: int
    used_late: int
    duplicate: int
    too_old: int
    clock_jump: int
    invalid: int


class FixCounts(TypedDict):
    accepted: int
    reanchored: int
    rejected: Dict[str, Any]


class _VehicleRequired(TypedDict):
    id: str
    map: str
    status: Literal["localized", "tracking_odometry", "lost", "stale"]
    pose: Optional[Pose]
    epoch: int
    silent_s: float
    last_heard: float
    since_fix: Optional[SinceFix]
    odometry: Optional[OdometryTrust]
    messages: MessageCounts
    fixes: FixCounts
    camera: VehicleCamera
    floor: Floor
    correct_camera: bool
    camera_correction: Optional[CameraCorrection]
    camera_estimate: CameraEstimate
    mask: Optional[MaskSummary]
    gate: Gate
    last_fix: Optional[FixRecord]


class Vehicle(_VehicleRequired, total=False):
    alternatives: List[Alternative]
    lost_reason: Literal["map_changed"]


class _VehicleSummaryRequired(TypedDict):
    id: str
    map: str
    status: Literal["localized", "tracking_odometry", "lost", "stale"]
    pose: Optional[Pose]
    epoch: int
    silent_s: float
    last_heard: float
    odometry: Optional[OdometryTrust]
    camera_status: Literal["learning", "as_calibrated", "corrected", "implausible"]
    last_fix: Optional[FixRecord]


class VehicleSummary(_VehicleSummaryRequired, total=False):
    alternatives: List[Alternative]
    lost_reason: Literal["map_changed"]


class VehicleList(TypedDict):
    vehicles: List[VehicleSummary]


class Finding(TypedDict):
    about: Literal["floor", "images", "camera", "odometry", "clock"]
    status: Literal["ok", "unknown", "note", "wrong"]
    sentence: str
    cure: str


class Diagnosis(TypedDict):
    vehicle: str
    status: Literal["ok", "unknown", "note", "wrong"]
    findings: List[Finding]
