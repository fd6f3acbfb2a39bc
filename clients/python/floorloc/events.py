# SPDX-License-Identifier: Apache-2.0
"""Server-sent events (WHATWG HTML, 9.2) on a connection of their own."""

from __future__ import annotations

import contextlib
import http.client
import json
import random
import socket
import time
from typing import Any, Dict, Generator, Iterator, List, Mapping, NamedTuple, Optional

from .connection import make_connection
from .errors import MALFORMED_ANSWER, UNREACHABLE, FloorlocError
from .retry import parse_retry_after

SILENCE_S = 45.0  # the server sends a comment every 15 s: three that are missing mean a dead connection
JITTER = 0.25
MAX_LINE_BYTES = 1 << 20


class Event(NamedTuple):
    """type: pose, status, fix, rejection, odometry, vehicle, map, or gap; data: as the OpenAPI document says."""

    type: str
    data: Dict[str, Any]
    id: Optional[str]


class EventParser:
    """Lines of a stream to events. last_id: of the last whole one, after which another connection goes on."""

    def __init__(self, last_id: Optional[str] = None) -> None:
        self.last_id = last_id
        self.retry_s = 1.0
        self._id = last_id
        self._type = ""
        self._data: List[str] = []

    def feed(self, line: str) -> Optional[Event]:
        """One line without its end; the event that it completes."""
        if not line:
            return self._complete()
        field, _, value = line.partition(":")
        value = value[1:] if value.startswith(" ") else value
        if field == "event":
            self._type = value
        elif field == "data":
            self._data.append(value)
        elif field == "id":
            self._id = value
        elif field == "retry" and value.isdigit():
            self.retry_s = int(value) / 1000.0
        return None

    def reset(self) -> None:
        """Forgets half an event, at the end of a connection."""
        self._type, self._data, self._id = "", [], self.last_id

    def _complete(self) -> Optional[Event]:
        kind, data = self._type or "message", "\n".join(self._data)
        self.last_id = self._id
        self.reset()
        return Event(kind, json.loads(data), self.last_id) if data else None


class EventStream:
    def __init__(self, url: str, target: str, headers: Mapping[str, str], timeout_s: float) -> None:
        self._url = url
        self._target = target
        self._headers = headers
        self._timeout_s = timeout_s

    def events(self, last_id: Optional[str], patience_s: float) -> Iterator[Event]:
        parser = EventParser(last_id)
        heard = time.monotonic()
        while True:
            wait_s = None
            try:
                with contextlib.closing(self._connected(parser)) as lines:
                    for event in lines:
                        if event is not None:
                            yield event
                        heard = time.monotonic()
            except FloorlocError as error:
                wait_s = error.retry_after_s
                again = error.status in (429, 503) or error.reason == UNREACHABLE
                if not again or time.monotonic() - heard > patience_s:
                    raise
            parser.reset()
            time.sleep((parser.retry_s if wait_s is None else wait_s) * random.uniform(1.0, 1.0 + JITTER))

    def _connected(self, parser: EventParser) -> Generator[Optional[Event], None, None]:
        """Events until the connection ends; None for each other line, a sign of life."""
        connection = make_connection(self._url)
        connection.timeout = self._timeout_s
        try:
            headers = {**self._headers, "Accept": "text/event-stream"}
            if parser.last_id is not None:
                headers["Last-Event-ID"] = parser.last_id
            connection.connect()
            assert connection.sock is not None
            sock = connection.sock
            connection.request("GET", self._target, headers=headers)
            response = connection.getresponse()
            if response.status != 200:
                raise _refusal(response)
            yield None
            sock.settimeout(SILENCE_S)
            while True:
                line = response.readline(MAX_LINE_BYTES)
                if not line.endswith(b"\n"):
                    return
                yield parser.feed(line.decode(errors="replace").rstrip("\r\n"))
        except socket.timeout:
            raise FloorlocError(UNREACHABLE, f"{self._url} went silent.") from None
        except (OSError, http.client.HTTPException) as error:
            raise FloorlocError(UNREACHABLE, f"{self._url} does not answer: {error or type(error).__name__}") from error
        finally:
            connection.close()


def _refusal(response: http.client.HTTPResponse) -> FloorlocError:
    retry_after_s = parse_retry_after(response.headers.get("Retry-After"))
    try:
        problem = json.loads(response.read())
        return FloorlocError(problem["code"], problem["detail"], response.status, retry_after_s,
                             response.headers.get("X-Request-Id"))
    except (ValueError, KeyError, TypeError):
        return FloorlocError(MALFORMED_ANSWER, "The answer is not that of a floorloc-server.", response.status,
                             retry_after_s)
