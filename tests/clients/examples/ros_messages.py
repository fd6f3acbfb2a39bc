# SPDX-License-Identifier: Apache-2.0
"""Stand-ins for the ROS 2 messages that the example fills: the fields and types of the .msg files of common_interfaces
(Humble to Jazzy), and no others."""


class Message:
    FIELDS = {}

    def __init__(self):
        for name, kind in self.FIELDS.items():
            object.__setattr__(self, name, kind() if isinstance(kind, type) else [0.0] * kind)

    def __setattr__(self, name, value):
        kind = self.FIELDS[name] if name in self.FIELDS else None
        if kind is None:
            raise AttributeError(f"{type(self).__name__} has no field {name}")
        if isinstance(kind, int):
            if len(value) != kind or any(type(one) is not float for one in value):
                raise TypeError(f"{type(self).__name__}.{name} takes {kind} floats")
        elif type(value) is not kind:  # as the setters of rosidl check
            raise TypeError(f"{type(self).__name__}.{name} is a {kind.__name__}, not {value!r}")
        object.__setattr__(self, name, value)


def message(name, **fields):
    return type(name, (Message,), {"FIELDS": fields})


Time = message("Time", sec=int, nanosec=int)
Header = message("Header", stamp=Time, frame_id=str)
Point = message("Point", x=float, y=float, z=float)
Vector3 = message("Vector3", x=float, y=float, z=float)
Quaternion = message("Quaternion", x=float, y=float, z=float, w=float)
Pose = message("Pose", position=Point, orientation=Quaternion)
PoseWithCovariance = message("PoseWithCovariance", pose=Pose, covariance=36)
PoseWithCovarianceStamped = message("PoseWithCovarianceStamped", header=Header, pose=PoseWithCovariance)
Transform = message("Transform", translation=Vector3, rotation=Quaternion)
TransformStamped = message("TransformStamped", header=Header, child_frame_id=str, transform=Transform)
