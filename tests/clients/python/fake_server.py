# SPDX-License-Identifier: Apache-2.0
"""A server that answers as it is told, and remembers what it was asked."""

import http.server
import json
import pathlib
import sys
import threading
from typing import NamedTuple

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parents[3] / "clients/python"))


class Asked(NamedTuple):
    method: str
    target: str
    headers: dict
    body: bytes
    connection: int  # ascending


def answer(status=200, body=None, **headers):
    return status, body or {}, {name.replace("_", "-"): value for name, value in headers.items()}


def problem(status, code, **headers):
    return answer(status, {"type": "about:blank", "title": "t", "status": status, "detail": f"Because of {code}.",
                           "code": code}, **headers)


def hang_up():
    """In the place of an answer: the connection is closed without one."""
    return None


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True

    def setup(self):
        super().setup()
        self.server.connections += 1
        self.number = self.server.connections
        self.server.sockets.append(self.connection)

    def handle_any(self):
        body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
        self.server.asked.append(Asked(self.command, self.path, dict(self.headers), body, self.number))
        script = self.server.script
        said = script.pop(0) if script else answer()
        said = said() if callable(said) else said
        if said is None:
            self.close_connection = True
            return
        status, content, headers = said
        text = content if isinstance(content, bytes) else json.dumps(content).encode() if status != 204 else b""
        self.send_response(status)
        for name, value in {"Content-Type": "application/json", "Content-Length": str(len(text)), **headers}.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(text)

    do_GET = do_POST = do_PUT = do_DELETE = handle_any

    def log_message(self, *_):
        pass


class FakeServer(http.server.ThreadingHTTPServer):
    daemon_threads = True

    def __init__(self, *script, port=0):
        super().__init__(("127.0.0.1", port), Handler)
        self.script, self.asked, self.sockets, self.connections = list(script), [], [], 0
        self.url = f"http://127.0.0.1:{self.server_address[1]}"
        threading.Thread(target=self.serve_forever, args=(0.01,), daemon=True).start()

    def handle_error(self, *_):
        pass  # clients that hang up

    def stop(self):
        self.shutdown()
        self.server_close()
        for connection in self.sockets:
            try:
                connection.shutdown(2)
            except OSError:
                pass
