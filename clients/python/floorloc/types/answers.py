# SPDX-License-Identifier: Apache-2.0
"""What localizing and tracking answer. Named as the schemas of schema/openapi.yaml, which explains every field."""

from __future__ import annotations

from typing import List, Literal, Optional, TypedDict

from .requests import Rectangle


class Pose(TypedDict):
    map: str
    map_version: str
    frame: Literal["map"]
    stamp: float
    x: float
    y: float
    yaw: float
    covariance: List[float]


class Transform(TypedDict):
    x: float
    y: float
    yaw: float


class Alternative(TypedDict):
    map: str
    map_version: str
    frame: Literal["map"]
    stamp: float
    x: float
    y: float
    yaw: float
    inliers: int
    weight: float


class PointMatch(TypedDict):
    base: List[float]
    map: List[float]
    inlier: bool


class CompetingPose(TypedDict):
    x: float
    y: float
    yaw: float
    inliers: int
    log10_nfa: float
    matches: List[PointMatch]


class Inspection(TypedDict):
    image: str
    region: Rectangle
    keypoints: List[List[float]]
    poses: List[CompetingPose]


class LatticePose(TypedDict):
    basis: List[List[float]]
    pose: Transform
    covariance: List[float]
    places: int


class CameraCorrection(TypedDict):
    survey: int
    moved_px: float


class _TimingRequired(TypedDict):
    queue: float
    decode: float
    rectify: float
    features: float
    match: float
    register: float
    total: float


class Timing(_TimingRequired, total=False):
    fusion: float


class _FixRequired(TypedDict):
    keypoints: int
    matches: int
    inliers: int
    rms_m: float
    p_wrong: float
    search: Literal["prior", "global"]


class Fix(_FixRequired, total=False):
    support_area: float
    jpeg_quality: int
    warning: str


class _LocalizeAnswerRequired(TypedDict):
    status: Literal["localized", "ambiguous", "not_localized"]
    fix: Fix
    alternatives: List[Alternative]
    camera_correction: Optional[CameraCorrection]
    timing_ms: Timing


class LocalizeAnswer(_LocalizeAnswerRequired, total=False):
    reason: Literal["too_few_keypoints", "too_few_matches", "too_few_inliers", "not_significant",
                    "contradicts_prior", "view_disagrees", "no_floor", "other_floor"]
    pose: Pose
    lattice: LatticePose
    inspection: Inspection


class _FixRecordRequired(TypedDict):
    sequence: int
    received: float
    stamp: float
    vehicle: Optional[str]
    status: Literal["localized", "ambiguous", "not_localized"]
    fix: Fix
    alternatives: List[Alternative]


class FixRecord(_FixRecordRequired, total=False):
    reason: Literal["too_few_keypoints", "too_few_matches", "too_few_inliers", "not_significant",
                    "contradicts_prior", "view_disagrees", "no_floor", "other_floor"]
    pose: Pose
    lattice: LatticePose
    accepted: bool
    reanchored: bool
    reject_reason: Literal["wrong_fix_risk", "jump_distance", "jump_angle", "mahalanobis", "too_old", "duplicate",
                           "invalid"]


class LastFrame(TypedDict):
    map: str
    map_version: str
    fix: FixRecord
    inspection: Inspection


class FixList(TypedDict):
    fixes: List[FixRecord]
    next: int


class SinceFix(TypedDict):
    seconds: float
    metres: float
    radians: float


class OdometryTrust(TypedDict):
    health: Literal["ok", "learning", "suspect", "rejected"]
    reason: Literal["", "reversed", "axes_swapped", "scale", "yaw_mirrored", "yaw_in_degrees", "standing",
                    "time_offset", "inconsistent"]
    cure: str
    scale: float
    yaw_scale: float
    time_offset_s: float


class Next(TypedDict):
    seconds: float
    metres: float


class _TrackingAnswerRequired(TypedDict):
    status: Literal["localized", "tracking_odometry", "lost"]
    epoch: int
    age_s: float
    since_fix: Optional[SinceFix]
    odometry: Optional[OdometryTrust]
    next: Next


class TrackingAnswer(_TrackingAnswerRequired, total=False):
    pose: Pose
    map_from_odom: Transform
    odom_from_base: Transform
    alternatives: List[Alternative]
    lost_reason: Literal["map_changed"]


class _OdometryAnswerRequired(TypedDict):
    message: Literal["used", "used_late", "duplicate", "too_old", "clock_jump", "invalid"]
    messages: List[Literal["used", "used_late", "duplicate", "too_old", "clock_jump", "invalid"]]
    status: Literal["localized", "tracking_odometry", "lost"]
    epoch: int
    age_s: float
    since_fix: Optional[SinceFix]
    odometry: Optional[OdometryTrust]
    next: Next


class OdometryAnswer(_OdometryAnswerRequired, total=False):
    pose: Pose
    map_from_odom: Transform
    odom_from_base: Transform
    alternatives: List[Alternative]
    lost_reason: Literal["map_changed"]


class _VehicleFixRequired(TypedDict):
    status: Literal["localized", "ambiguous", "not_localized"]
    accepted: bool
    reanchored: bool
    keypoints: int
    matches: int
    inliers: int
    rms_m: float
    p_wrong: float
    search: Literal["prior", "global"]


class VehicleFix(_VehicleFixRequired, total=False):
    reason: Literal["too_few_keypoints", "too_few_matches", "too_few_inliers", "not_significant",
                    "contradicts_prior", "view_disagrees", "no_floor", "other_floor"]
    reject_reason: Literal["wrong_fix_risk", "jump_distance", "jump_angle", "mahalanobis", "too_old", "duplicate",
                           "invalid"]
    support_area: float
    jpeg_quality: int
    warning: str
    pose: Pose


class _FrameAnswerRequired(TypedDict):
    message: Literal["used", "used_late", "duplicate", "too_old", "clock_jump", "invalid"]
    fix: VehicleFix
    alternatives: List[Alternative]
    camera_correction: Optional[CameraCorrection]
    masked_share: float
    timing_ms: Timing
    status: Literal["localized", "tracking_odometry", "lost"]
    epoch: int
    age_s: float
    since_fix: Optional[SinceFix]
    odometry: Optional[OdometryTrust]
    next: Next


class FrameAnswer(_FrameAnswerRequired, total=False):
    pose: Pose
    lattice: LatticePose
    map_from_odom: Transform
    odom_from_base: Transform
    lost_reason: Literal["map_changed"]
