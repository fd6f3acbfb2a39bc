# SPDX-License-Identifier: Apache-2.0
"""One vehicle: its images, its odometry in batches, and when the server wants its next image."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Mapping, Optional, Sequence, TypeVar, Union

from .errors import FloorlocError
from .types import FrameAnswer, Increment, OdometryAnswer, RosVehicle, TrackingAnswer, Vehicle

if TYPE_CHECKING:
    from .client import Client

Answer = TypeVar("Answer")
Stamp = Union[int, float, str]

MAX_INCREMENTS = 1000  # of one body, by the OpenAPI document
STAMP_STEP_S = 1e-6  # doubles have Unix times to 0.2 us


class VehicleClient:
    """A registered vehicle, Client.register() makes it. For one thread at a time.

    move() collects odometry and sends it in batches; frame() sends what was collected, then the image. Odometry that
    could not be sent is kept for the next call, and what arrived without the client hearing of it counts once.
    When the server has forgotten the vehicle it is registered again.
    """

    def __init__(self, client: "Client", id: str, registration: Optional[Mapping[str, Any]] = None,
                 batch_s: float = 0.1) -> None:
        """registration: of PUT /v1/vehicles/{id}; batch_s: how long increments are collected, by their stamps."""
        self.client = client
        self.id = id
        self.batch_s = batch_s
        self._registration = registration
        self._pending: List[Dict[str, Any]] = []
        self._next_at_s = -math.inf  # the server wants an image from this stamp on
        self._next_after_m = 0.0  # or when so much more was driven

    @property
    def pending(self) -> int:
        """Increments that were not sent yet."""
        return len(self._pending)

    def move(self, stamp: Stamp, dx: float, dy: float, dyaw: float,
             deadline_s: Optional[float] = None) -> Optional[OdometryAnswer]:
        """Adds the motion (m, m, rad) since the previous one, base frame; sends it with the batch, else None."""
        for number in (float(stamp), dx, dy, dyaw):
            if not math.isfinite(number):
                raise ValueError(f"odometry at {stamp} is not finite: {dx}, {dy}, {dyaw}")
        self._pending.append({"stamp": stamp, "dx": dx, "dy": dy, "dyaw": dyaw})
        if len(self._pending) > MAX_INCREMENTS:  # the server was away for long
            self._pending[:2] = [_composed(*self._pending[:2])]
        self._next_after_m -= math.hypot(dx, dy)
        first_s = float(self._pending[0]["stamp"])
        return self.flush(deadline_s) if abs(float(stamp) - first_s) >= self.batch_s - STAMP_STEP_S else None

    def flush(self, deadline_s: Optional[float] = None) -> Optional[OdometryAnswer]:
        """Sends the odometry that was collected; None when there is none."""
        if not self._pending:
            return None
        increments: List[Increment] = list(self._pending)  # type: ignore[arg-type]
        answer = self._registered(lambda: self.client.post_odometry(self.id, increments, deadline_s))
        self._pending.clear()
        self._note_next(answer, float(increments[-1]["stamp"]))
        return answer

    def frame(self, image: bytes, stamp: Optional[Stamp] = None, deadline_s: Optional[float] = None) -> FrameAnswer:
        """Localizes a JPEG or PNG and answers the fused pose; stamp: when it was taken, by default now.

        Give a deadline in a control loop: without it a server that is busy is asked again, with waits of seconds.
        """
        stamp = time.time() if stamp is None else stamp
        start = time.monotonic()
        self.flush(deadline_s)
        left_s = None if deadline_s is None else deadline_s - (time.monotonic() - start)
        answer = self._registered(lambda: self.client.post_frame(self.id, image, stamp, deadline_s=left_s))
        self._note_next(answer, float(stamp))
        return answer

    def wants_frame(self, stamp: Optional[float] = None) -> bool:
        """Whether the server wants an image by now, by `next` of its last answer and what was driven since."""
        return (time.time() if stamp is None else stamp) >= self._next_at_s or self._next_after_m <= 0.0

    def initial_pose(self, x: float, y: float, yaw: float, covariance: Optional[Sequence[float]] = None,
                     stamp: Optional[Stamp] = None) -> TrackingAnswer:
        """Sets the pose by hand; the server wants an image then."""
        answer = self._registered(lambda: self.client.post_initial_pose(self.id, x, y, yaw, covariance, stamp))
        self._next_at_s = -math.inf
        return answer

    def info(self) -> Vehicle:
        return self.client.get_vehicle(self.id)

    def ros(self) -> RosVehicle:
        return self.client.get_ros_vehicle(self.id)

    def remove(self) -> bool:
        """Unregisters the vehicle; False when the server did not know it."""
        return self.client.delete_vehicle(self.id)

    def _registered(self, call: Callable[[], Answer]) -> Answer:
        try:
            return call()
        except FloorlocError as error:
            if error.reason != "unknown_vehicle" or self._registration is None:
                raise
        self.client.put_vehicle(self.id, self._registration)
        return call()

    def _note_next(self, answer: Union[FrameAnswer, OdometryAnswer], stamp_s: float) -> None:
        self._next_at_s = stamp_s + answer["next"]["seconds"]
        self._next_after_m = answer["next"]["metres"]


def _composed(first: Mapping[str, Any], second: Mapping[str, Any]) -> Dict[str, Any]:
    """One increment of two: the second is in the base frame at the end of the first."""
    cosine, sine = math.cos(first["dyaw"]), math.sin(first["dyaw"])
    return {"stamp": second["stamp"],
            "dx": first["dx"] + cosine * second["dx"] - sine * second["dy"],
            "dy": first["dy"] + sine * second["dx"] + cosine * second["dy"],
            "dyaw": first["dyaw"] + second["dyaw"]}
