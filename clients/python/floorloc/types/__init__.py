# SPDX-License-Identifier: Apache-2.0
"""The JSON of requests and answers as TypedDict: dictionaries, whose keys type checkers know."""

from .answers import (
    Alternative, CameraCorrection, Fix, FixList, FixRecord, FrameAnswer, LatticePose, LocalizeAnswer, Next,
    OdometryAnswer, OdometryTrust, Pose, SinceFix, Timing, TrackingAnswer, Transform, VehicleFix,
)
from .maps import (
    FloorLattice, Layer, Map, MapList, MapSummary, Mosaic, RefusedFile, Scale, Version,
)
from .requests import (
    Calibration, Camera, Floor, Gate, Increment, InitialPose, Motion, Rectangle, Twist, VehicleRequest,
)
from .ros import (
    RosHeader, RosPose, RosPoseWithCovariance, RosPoseWithCovarianceStamped, RosQuaternion, RosTime,
    RosTransform, RosTransformStamped, RosVector3, RosVehicle,
)
from .vehicles import (
    CameraEstimate, CameraMounting, Diagnosis, Finding, FixCounts, MaskSummary, MessageCounts, Vehicle,
    VehicleCamera, VehicleList, VehicleSummary,
)

__all__ = [
    "Alternative", "Calibration", "Camera", "CameraCorrection", "CameraEstimate", "CameraMounting",
    "Diagnosis", "Finding", "Fix", "FixCounts", "FixList", "FixRecord", "Floor", "FloorLattice", "FrameAnswer",
    "Gate", "Increment", "InitialPose", "LatticePose", "Layer", "LocalizeAnswer", "Map", "MapList", "MapSummary", "MaskSummary",
    "MessageCounts", "Mosaic", "Motion", "Next", "OdometryAnswer", "OdometryTrust", "Pose", "Rectangle",
    "RefusedFile", "RosHeader", "RosPose", "RosPoseWithCovariance", "RosPoseWithCovarianceStamped",
    "RosQuaternion", "RosTime", "RosTransform", "RosTransformStamped", "RosVector3", "RosVehicle", "Scale",
    "SinceFix", "Timing", "TrackingAnswer", "Transform", "Twist", "Vehicle", "VehicleCamera", "VehicleFix",
    "VehicleList", "VehicleRequest", "VehicleSummary", "Version",
]
