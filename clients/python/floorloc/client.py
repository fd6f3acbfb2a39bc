# SPDX-License-Identifier: Apache-2.0
"""The calls of a floorloc-server."""

from __future__ import annotations

import itertools
import json
import threading
import time
import urllib.parse
from typing import Any, Dict, Iterator, List, Mapping, Optional, Sequence, Union

from .connection import Connection, Request, Response
from .errors import MALFORMED_ANSWER, Deadline, FloorlocError
from .events import Event, EventStream
from .image_body import content_type_of, multipart
from .retry import Retry, parse_retry_after
from .types import (
    Calibration, Camera, Diagnosis, FixList, Floor, FrameAnswer, Gate, Increment, LastFrame, LocalizeAnswer, Map,
    MapList, MapSuccess, OdometryAnswer, RosVehicle, TrackingAnswer, Vehicle, VehicleList,
)
from .vehicle import VehicleClient

Number = Union[int, float]
Stamp = Union[int, float, str]  # Unix time in seconds; a string keeps more digits

MAX_SERVER_DEADLINE_MS = 60_000


class Client:
    """The calls of one server, named after the operations of its OpenAPI document.

    Every call answers the server's JSON as it is, typed by the classes of floorloc.types, or raises FloorlocError. It
    returns within deadline_s, by default timeout_s, all attempts (`retry`) and waits between them included.

    One keep-alive connection, opened by the first call. May be shared between threads: their calls follow one another,
    so threads that should not wait for each other's images have a client each. Also a context manager, which closes it.
    """

    def __init__(self, url: str = "http://127.0.0.1:8080", token: Optional[str] = None, timeout_s: float = 10.0,
                 retry: Retry = Retry()) -> None:
        self.url = url
        self.timeout_s = timeout_s
        self.retry = retry
        self._headers = {"Authorization": f"Bearer {token}"} if token else {}
        self._connection = Connection(url)
        self._lock = threading.Lock()

    def __enter__(self) -> "Client":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Closes the connection; the next call opens another one."""
        with self._lock:
            self._connection.close()

    # --- images, odometry, poses ---

    def register(self, vehicle: str, map: str, camera: Camera, floor: Floor, mask: Optional[str] = None,
                 gate: Optional[Gate] = None, correct_camera: Optional[bool] = None) -> VehicleClient:
        """Registers a vehicle, or replaces it, and returns what sends its images and odometry.

        read_calibration() has camera, floor and mask of a folder:
        client.register("agv7", "hall", **read_calibration(FOLDER))
        """
        registration = _given(map=map, camera=camera, floor=floor, mask=mask, gate=gate, correct_camera=correct_camera)
        self.put_vehicle(vehicle, registration)
        return VehicleClient(self, vehicle, registration)

    def localize(self, map: str, image: bytes, *, vehicle: Optional[str] = None,
                 calibration: Optional[Calibration] = None, prior: Optional[Sequence[Number]] = None,
                 radius: Optional[float] = None, twist: Optional[Sequence[Number]] = None,
                 stamp: Optional[Stamp] = None, inspect: Optional[bool] = None,
                 deadline_s: Optional[float] = None) -> LocalizeAnswer:
        """Localizes one JPEG or PNG, stateless, with the camera of a registered vehicle or with this calibration.

        prior: (x, y, yaw) in the map, m and rad, within radius metres of which the robot is sought first. twist: its
        velocity (vx, vy, wz), base frame, for rolling shutters. inspect: the answer has `inspection`. A deadline is
        told to the server, which otherwise refuses at once what would take longer than its own (80 ms by default).
        """
        path = f"/v1/maps/{_quoted(map)}/localize"
        if calibration is None:
            query = {"vehicle": vehicle, "prior": _commas(prior), "radius": radius, "twist": _commas(twist),
                     "stamp": stamp, "inspect": None if inspect is None else str(inspect).lower()}
            return self.call("POST", path, query=query, body=image, content_type=content_type_of(image),
                             deadline_s=deadline_s, tell_server=True)
        velocity = None if twist is None else dict(zip(("vx", "vy", "wz"), twist))
        request = _given(vehicle=vehicle, prior=_listed(prior), radius=radius, twist=velocity, stamp=stamp,
                         inspect=inspect)
        body, content_type = multipart(image, {**calibration, **request})
        return self.call("POST", path, body=body, content_type=content_type, deadline_s=deadline_s, tell_server=True)

    def post_frame(self, vehicle: str, image: bytes, stamp: Stamp, odometry: Optional[Sequence[Number]] = None,
                   deadline_s: Optional[float] = None) -> FrameAnswer:
        """Localizes a JPEG or PNG, and fuses it with all messages of the vehicle so far.

        odometry: the motion (dx, dy, dyaw) since its previous message, base frame, m and rad. Sent again, an image and
        its odometry count once.
        """
        query = {"stamp": stamp, "odometry": _commas(odometry)}
        return self.call("POST", f"{_vehicle(vehicle)}/frames", query=query, body=image,
                         content_type=content_type_of(image), deadline_s=deadline_s, tell_server=True)

    def post_odometry(self, vehicle: str, increments: Sequence[Increment],
                      deadline_s: Optional[float] = None) -> OdometryAnswer:
        """Sends up to 1000 increments; those that the server knows already, by their stamps, count once."""
        return self.call("POST", f"{_vehicle(vehicle)}/odometry", body={"increments": list(increments)},
                         deadline_s=deadline_s)

    def post_initial_pose(self, vehicle: str, x: float, y: float, yaw: float,
                          covariance: Optional[Sequence[float]] = None, stamp: Optional[Stamp] = None,
                          deadline_s: Optional[float] = None) -> TrackingAnswer:
        """Sets the pose; covariance: of (x, y, yaw), 9 numbers row by row, by default of 0.1 m and 0.1 rad."""
        body = _given(x=x, y=y, yaw=yaw, covariance=_listed(covariance), stamp=stamp)
        return self.call("POST", f"{_vehicle(vehicle)}/initialpose", body=body, deadline_s=deadline_s)

    # --- vehicles ---

    def put_vehicle(self, vehicle: str, registration: Mapping[str, Any]) -> Vehicle:
        return self.call("PUT", _vehicle(vehicle), body=registration)

    def get_vehicle(self, vehicle: str) -> Vehicle:
        return self.call("GET", _vehicle(vehicle))

    def get_ros_vehicle(self, vehicle: str) -> RosVehicle:
        """Its pose in the field names of ROS 2 messages."""
        return self.call("GET", _vehicle(vehicle), query={"format": "ros"})

    def list_vehicles(self) -> VehicleList:
        return self.call("GET", "/v1/vehicles")

    def get_diagnosis(self, vehicle: str) -> Diagnosis:
        return self.call("GET", f"{_vehicle(vehicle)}/diagnosis")

    def get_last_frame(self, vehicle: str) -> LastFrame:
        return self.call("GET", f"{_vehicle(vehicle)}/last_frame")

    def delete_vehicle(self, vehicle: str) -> bool:
        """False when there was none."""
        try:
            self.call("DELETE", _vehicle(vehicle))
        except FloorlocError as error:
            if error.reason != "unknown_vehicle":
                raise
            return False
        return True

    # --- maps, events, readiness ---

    def list_maps(self) -> MapList:
        return self.call("GET", "/v1/maps")

    def get_map(self, map: str) -> Map:
        return self.call("GET", f"/v1/maps/{_quoted(map)}")

    def get_success(self, map: str) -> MapSuccess:
        return self.call("GET", f"/v1/maps/{_quoted(map)}/success")

    def list_fixes(self, map: str, since: int = 0) -> FixList:
        return self.call("GET", f"/v1/maps/{_quoted(map)}/fixes", query={"since": since})

    def stream_events(self, map: Optional[str] = None, vehicle: Optional[str] = None,
                      types: Optional[Sequence[str]] = None, last_event_id: Optional[str] = None,
                      patience_s: float = 60.0) -> Iterator[Event]:
        """What happens, as it happens, without end; close() the iterator to stop.

        On a connection of its own, which is opened again when it breaks; the events in between are not lost, or one of
        the type `gap` says that they are. Raises FloorlocError when there was no connection for patience_s, and at once
        for what is wrong with the call.
        """
        query = {"map": map, "vehicle": vehicle, "types": types and ",".join(types)}
        stream = EventStream(self.url, f"/v1/events{_query(query)}", self._headers, self.timeout_s)
        return stream.events(last_event_id, patience_s)

    def is_ready(self) -> bool:
        """Whether the server takes work; False when it does not answer."""
        try:
            self._attempt(Request("GET", "/readyz", None, {}), Deadline(self.timeout_s))
        except FloorlocError:
            return False
        return True

    def wait_until_ready(self, timeout_s: float = 30.0) -> None:
        """Raises FloorlocError when the server was not ready within this time."""
        deadline = Deadline(timeout_s)
        while not self.is_ready():
            if not deadline.allows(0.1):
                raise deadline.exceeded()
            time.sleep(0.1)

    # --- all others ---

    def call(self, method: str, path: str, *, query: Optional[Mapping[str, Any]] = None, body: Any = None,
             content_type: str = "application/json", deadline_s: Optional[float] = None, tell_server: bool = False,
             repeatable: bool = True) -> Any:
        """Any call of the OpenAPI document: the JSON of its answer, None without one, bytes of another type.

        body: bytes, or what becomes JSON. query: values that are None are left out. tell_server: send the deadline.
        repeatable: doing it twice has the effect of doing it once: it may be sent again when a connection broke.
        """
        headers = dict(self._headers)
        if body is not None:
            headers["Content-Type"] = content_type
            body = body if isinstance(body, bytes) else json.dumps(body, allow_nan=False).encode()
        request = Request(method, f"{path}{_query(query or {})}", body, headers, repeatable)
        deadline = Deadline(self.timeout_s if deadline_s is None else deadline_s)
        for attempt in itertools.count(1):
            try:
                return self._attempt(request, deadline, tell_server and deadline_s is not None)
            except FloorlocError as error:
                wait_s = self.retry.wait_s(error, attempt)
                again = repeatable or error.status is not None
                if wait_s is None or not again or not deadline.allows(wait_s):
                    raise
            time.sleep(wait_s)
        raise AssertionError("unreachable")

    def _attempt(self, request: Request, deadline: Deadline, tell_server: bool = False) -> Any:
        if not self._lock.acquire(timeout=deadline.left_s()):
            raise deadline.exceeded()
        try:
            if tell_server:
                left_ms = max(1, min(MAX_SERVER_DEADLINE_MS, int(1000 * deadline.left_s())))
                request = request._replace(headers={**request.headers, "X-Deadline-Ms": str(left_ms)})
            response = self._connection.exchange(request, deadline)
        finally:
            self._lock.release()
        if response.status >= 300:
            raise _error_of(response)
        return _content_of(response)


def _content_of(response: Response) -> Any:
    if not response.body:
        return None
    if not response.headers.get("Content-Type", "").startswith("application/json"):
        return response.body
    try:
        return json.loads(response.body)
    except ValueError:
        raise FloorlocError(MALFORMED_ANSWER, "The answer is no JSON; is this a floorloc-server?",
                            response.status) from None


def _error_of(response: Response) -> FloorlocError:
    retry_after_s = parse_retry_after(response.headers.get("Retry-After"))
    request_id = response.headers.get("X-Request-Id")
    try:
        problem: Dict[str, Any] = json.loads(response.body)
        return FloorlocError(problem["code"], problem["detail"], response.status, retry_after_s, request_id)
    except (ValueError, KeyError, TypeError):
        begin = response.body[:200].decode(errors="replace").strip()
        detail = f"The answer is not that of a floorloc-server: {begin or 'nothing'}"
        return FloorlocError(MALFORMED_ANSWER, detail, response.status, retry_after_s, request_id)


def _quoted(name: str) -> str:
    return urllib.parse.quote(name, safe="")


def _vehicle(name: str) -> str:
    return f"/v1/vehicles/{_quoted(name)}"


def _given(**fields: Any) -> Dict[str, Any]:
    return {key: value for key, value in fields.items() if value is not None}


def _listed(numbers: Optional[Sequence[Number]]) -> Optional[List[float]]:
    return None if numbers is None else [float(number) for number in numbers]


def _commas(numbers: Optional[Sequence[Number]]) -> Optional[str]:
    return None if numbers is None else ",".join(repr(float(number)) for number in numbers)


def _query(fields: Mapping[str, Any]) -> str:
    given = _given(**fields)
    return f"?{urllib.parse.urlencode(given)}" if given else ""
