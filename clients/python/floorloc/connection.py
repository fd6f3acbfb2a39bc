# SPDX-License-Identifier: Apache-2.0
"""One keep-alive connection to a server."""

from __future__ import annotations

import http.client
import socket
import urllib.parse
from typing import Mapping, NamedTuple, Optional

from .errors import UNREACHABLE, Deadline, FloorlocError

CHUNK_BYTES = 65536


class Request(NamedTuple):
    method: str
    target: str  # path and query
    body: Optional[bytes]
    headers: Mapping[str, str]
    repeatable: bool = True  # doing it twice has the effect of doing it once


class Response(NamedTuple):
    status: int
    headers: Mapping[str, str]  # http.client's, which ignores case
    body: bytes


def make_connection(url: str) -> http.client.HTTPConnection:
    """A connection, not opened yet. Raises ValueError for what is no address of a server."""
    address = urllib.parse.urlsplit(url)
    kinds = {"http": http.client.HTTPConnection, "https": http.client.HTTPSConnection}
    if address.scheme not in kinds or not address.hostname or address.path not in ("", "/"):
        raise ValueError(f"'{url}' is no address of a server, such as http://localhost:8080")
    return kinds[address.scheme](address.hostname, address.port)


class Connection:
    """Opened by the first request, and again when the server has closed it. For one thread at a time."""

    def __init__(self, url: str) -> None:
        self._url = url
        self._http = make_connection(url)

    def close(self) -> None:
        self._http.close()

    def exchange(self, request: Request, deadline: Deadline) -> Response:
        """Sends a request and reads its answer. Raises FloorlocError without one."""
        try:
            reused = self._open(deadline)
            try:
                return self._exchange_once(request, deadline)
            except (ConnectionError, http.client.BadStatusLine):
                # Most likely the server closed the idle connection while the request was on its way.
                self.close()
                if not (reused and request.repeatable):
                    raise
            self._open(deadline)
            return self._exchange_once(request, deadline)
        except socket.timeout:
            self.close()
            raise deadline.exceeded() from None
        except (OSError, http.client.HTTPException) as error:
            self.close()
            raise FloorlocError(UNREACHABLE, f"{self._url} does not answer: {error or type(error).__name__}") from error
        except BaseException:  # half an answer may be left in the connection
            self.close()
            raise

    def _open(self, deadline: Deadline) -> bool:
        """True when the connection was open already."""
        if self._http.sock is not None and self._was_closed_by_server():
            self.close()
        if self._http.sock is not None:
            return True
        self._http.timeout = deadline.left_s()
        self._http.connect()
        return False

    def _was_closed_by_server(self) -> bool:
        sock = self._http.sock
        if sock is None or isinstance(self._http, http.client.HTTPSConnection):  # TLS sockets cannot peek
            return False
        sock.setblocking(False)
        try:
            sock.recv(1, socket.MSG_PEEK)
        except BlockingIOError:
            return False
        except OSError:
            return True
        return True  # the end, or an answer that nobody asked for

    def _exchange_once(self, request: Request, deadline: Deadline) -> Response:
        sock = self._http.sock
        assert sock is not None
        sock.settimeout(deadline.left_s())
        try:
            self._http.request(request.method, request.target, request.body, dict(request.headers))
        except ConnectionError:
            # A server that refuses a call may answer, and close, before it has taken the whole body.
            try:
                return self._read(sock, deadline)
            except (http.client.HTTPException, ConnectionError):
                pass
            raise
        return self._read(sock, deadline)

    def _read(self, sock: socket.socket, deadline: Deadline) -> Response:
        sock.settimeout(deadline.left_s())
        response = self._http.getresponse()
        parts = []
        while not response.isclosed():
            if sock.fileno() >= 0:
                sock.settimeout(deadline.left_s())
            parts.append(response.read1(CHUNK_BYTES))
            if not parts[-1]:
                break
        response.read()  # raises IncompleteRead when the connection broke before the end
        return Response(response.status, response.headers, b"".join(parts))
