# SPDX-License-Identifier: Apache-2.0
"""The JSON of requests and answers as TypedDict: dictionaries, whose keys type checkers know."""

from .answers import (
    Alternative, CameraCorrection, CompetingPose, Fix, FixList, FixRecord, FrameAnswer, Inspection, LastFrame,
    LatticePose, LocalizeAnswer, Next, OdometryAnswer, OdometryTrust, PointMatch, Pose, SinceFix, Timing, TrackingAnswer, Transform, VehicleFix,
)
from .maps import (
    FloorLattice, Layer, Map, MapList, MapSuccess, MapSummary, Mosaic, RefusedFile, Scale, SuccessSquare, Version,
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
    "CompetingPose", "Diagnosis", "Finding", "Fix", "FixCounts", "FixList", "FixRecord", "Floor",
    "FloorLattice", "FrameAnswer", "Gate", "Increment", "InitialPose", "Inspection", "LastFrame",
    "LatticePose", "Layer", "LocalizeAnswer", "Map", "MapList", "MapSuccess", "MapSummary", "MaskSummary",
    "MessageCounts", "Mosaic", "Motion", "Next", "OdometryAnswer", "OdometryTrust", "PointMatch", "Pose",
    "Rectangle", "RefusedFile", "RosHeader", "RosPose", "RosPoseWithCovariance",
    "RosPoseWithCovarianceStamped", "RosQuaternion", "RosTime", "RosTransform", "RosTransformStamped",
    "RosVector3", "RosVehicle", "Scale", "SinceFix", "SuccessSquare", "Timing", "TrackingAnswer", "Transform",
    "Twist", "Vehicle", "VehicleCamera", "VehicleFix", "VehicleList", "VehicleRequest", "VehicleSummary",
    "Version",
]
