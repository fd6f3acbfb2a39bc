# SPDX-License-Identifier: Apache-2.0
"""Client of floorloc-server: where is the robot, by an image of the floor.

    client = Client("http://localhost:8080")
    vehicle = client.register("agv7", "hall", **read_calibration("SURVEY"))
    answer = vehicle.frame(jpeg)
"""

from .calibration import read_calibration
from .client import Client
from .errors import FloorlocError
from .events import Event
from .retry import Retry
from .vehicle import VehicleClient

__all__ = ["Client", "Event", "FloorlocError", "Retry", "VehicleClient", "read_calibration"]
