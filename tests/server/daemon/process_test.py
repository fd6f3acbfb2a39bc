#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The real server process: exit codes, signals, a log without a reader. Usage: process_test.py FLOORLOC_SERVER"""

import json
import os
import pathlib
import re
import resource
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.error
import urllib.request

SERVER = sys.argv.pop() if len(sys.argv) > 1 else "floorloc-server"


class ProcessTest(unittest.TestCase):
    def setUp(self):
        self.maps = tempfile.TemporaryDirectory()
        self.addCleanup(self.maps.cleanup)

    def start(self, *options, **environment):
        process = subprocess.Popen([SERVER, "--maps", self.maps.name, "--listen", "127.0.0.1:0", *options], text=True,
                                   stderr=subprocess.PIPE, env=os.environ | environment)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        for line in process.stderr:
            found = re.search(r"http://127\.0\.0\.1:(\d+)/", line)
            if found:
                return process, int(found.group(1))
        raise AssertionError("the server did not start")

    def alive(self, port):
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/livez", timeout=5) as answer:
            return answer.status == 200

    def test_wrong_options_exit_with_2(self):
        config = pathlib.Path(self.maps.name) / "config.json"
        config.write_text('{"protect_reads": true}')
        for options in (["--bogus"], ["--maps"], [], ["--maps", self.maps.name, "--listen", "nonsense"],
                        ["--maps", self.maps.name, "--listen", "0.0.0.0:0"],
                        ["--maps", self.maps.name, "--config", str(config)]):
            result = subprocess.run([SERVER, *options], capture_output=True, text=True, timeout=20, check=False)
            self.assertEqual(result.returncode, 2, options)
            self.assertTrue(result.stderr, options)

    def test_files_that_cannot_be_used_exit_with_1(self):
        for options in (["--maps", "/nowhere"], ["--maps", self.maps.name, "--config", "/nowhere"]):
            result = subprocess.run([SERVER, *options], capture_output=True, text=True, timeout=20, check=False)
            self.assertEqual(result.returncode, 1, options)

    def test_half_a_request_does_not_delay_the_stop(self):
        process, port = self.start()
        with socket.create_connection(("127.0.0.1", port)) as client:
            client.sendall(b"GET /livez HTTP/1.1\r\nHo")
            time.sleep(0.2)
            start = time.monotonic()
            process.send_signal(signal.SIGTERM)
            self.assertEqual(process.wait(timeout=20), 0)
            self.assertLess(time.monotonic() - start, 5)

    def test_it_drains_for_drain_s_and_stops_whatever_clients_do(self):
        config = pathlib.Path(self.maps.name) / "config.json"
        config.write_text('{"drain_s": 0.5}')
        process, port = self.start("--config", str(config))
        begins = (b"", b"GET /livez HTTP/1.1\r\nHo", b"POST /v1/maps/a/localize HTTP/1.1\r\nHost: x\r\n",
                  b"PUT /v1/vehicles/a HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\nContent-Length: 9\r\n\r\n{",
                  b"GET /v1/events HTTP/1.1\r\nHost: x\r\n\r\n",  # a stream that nobody reads
                  b"GET /openapi.yaml HTTP/1.1\r\nHost: x\r\n\r\n" * 200)  # answers that nobody takes
        clients = [socket.create_connection(("127.0.0.1", port)) for _ in range(5 * len(begins))]
        self.addCleanup(lambda: [client.close() for client in clients])
        for client, begin in zip(clients, begins * 5):
            client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            client.setblocking(False)
            client.send(begin)
        time.sleep(0.2)
        start = time.monotonic()
        process.send_signal(signal.SIGTERM)
        time.sleep(0.2)
        with self.assertRaises(urllib.error.HTTPError) as draining:
            urllib.request.urlopen(f"http://127.0.0.1:{port}/readyz", timeout=5)
        self.assertEqual((draining.exception.code, json.load(draining.exception)["code"]), (503, "draining"))
        self.assertTrue(self.alive(port))  # still answers: a balancer needs the time to notice
        while process.poll() is None and time.monotonic() - start < 20:
            for client in clients[1:]:  # some send a byte every moment
                try:
                    client.send(b"x")
                except OSError:
                    pass
            time.sleep(0.05)
        self.assertEqual(process.wait(timeout=1), 0)
        self.assertGreater(time.monotonic() - start, 0.5)
        self.assertLess(time.monotonic() - start, 0.5 + 4)

    def test_it_tells_the_service_manager_what_it_does(self):
        for name in (str(pathlib.Path(self.maps.name) / "notify"), f"@floorloc-test-{os.getpid()}"):
            with self.subTest(name), socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
                manager.bind(name.replace("@", "\0", 1))
                manager.settimeout(10)
                process, port = self.start(NOTIFY_SOCKET=name)
                self.assertEqual(manager.recv(1000).decode().splitlines(),
                                 ["READY=1", f"STATUS=serving 0 maps on http://127.0.0.1:{port}/"])
                process.send_signal(signal.SIGHUP)
                self.assertRegex(manager.recv(1000).decode(), r"\ARELOADING=1\nMONOTONIC_USEC=\d+\Z")
                self.assertEqual(manager.recv(1000), b"READY=1")
                process.send_signal(signal.SIGTERM)
                self.assertEqual(manager.recv(1000), b"STOPPING=1\nSTATUS=draining")
                self.assertEqual(process.wait(timeout=20), 0)

    def test_the_log_is_json_with_request_ids_on_wish(self):
        config = pathlib.Path(self.maps.name) / "config.json"
        config.write_text('{"log_format": "json", "access_log": true}')
        process, port = self.start("--config", str(config))
        trace = "4bf92f3577b34da6a3ce929d0e0e4736"
        for method, path in (("GET", "/v1/maps"), ("DELETE", "/v1/vehicles/agv7"), ("GET", "/livez")):
            request = urllib.request.Request(f"http://127.0.0.1:{port}{path}", method=method, headers={
                "X-Request-Id": f"{method}-1", "traceparent": f"00-{trace}-00f067aa0ba902b7-01"})
            try:
                answer = urllib.request.urlopen(request, timeout=5)
            except urllib.error.HTTPError as problem:
                answer = problem
            self.assertEqual(answer.headers["X-Request-Id"], f"{method}-1")
            self.assertRegex(answer.headers["traceparent"], f"^00-{trace}-[0-9a-f]{{16}}-01$")
            answer.close()
        process.send_signal(signal.SIGTERM)
        lines = [json.loads(line) for line in process.stderr]
        for line in lines:
            self.assertRegex(line["time"], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z$")
            self.assertEqual(line["level"], "info")
        access = [line for line in lines if line["message"] == "access"]
        self.assertEqual([(line["method"], line["path"], line["status"]) for line in access],
                         [("GET", "/v1/maps", 200), ("DELETE", "/v1/vehicles/agv7", 404)])
        self.assertEqual((access[1]["request_id"], access[1]["trace_id"], access[1]["problem"]),
                         ("DELETE-1", trace, "unknown_vehicle"))
        audit = [line for line in lines if line["message"].startswith("audit: DELETE")]
        self.assertEqual([(line["request_id"], line["trace_id"]) for line in audit], [("DELETE-1", trace)])

    def test_it_runs_without_a_service_manager(self):
        for name in ("", "relative", "/nowhere/notify", "/" + 200 * "x"):
            process, port = self.start(NOTIFY_SOCKET=name)
            self.assertTrue(self.alive(port), name)
            process.kill()

    def test_a_hangup_and_a_closed_log_leave_it_running(self):
        process, port = self.start()
        process.send_signal(signal.SIGHUP)
        time.sleep(0.2)
        self.assertTrue(self.alive(port))
        process.stderr.close()
        process.send_signal(signal.SIGHUP)  # is logged
        time.sleep(0.2)
        self.assertTrue(self.alive(port))
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(timeout=20), 0)

    def test_idle_sockets_lock_nobody_out(self):
        hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
        resource.setrlimit(resource.RLIMIT_NOFILE, (256, hard))  # of the server, which asks for more
        _, port = self.start()
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, 4096), hard))  # of this process
        idle = [socket.create_connection(("127.0.0.1", port)) for _ in range(1024)]
        try:
            self.assertTrue(self.alive(port))
            with socket.create_connection(("127.0.0.1", port), source_address=("127.0.0.2", 0), timeout=5) as other:
                other.sendall(b"GET /v1/maps HTTP/1.1\r\nHost: x\r\n\r\n")
                self.assertTrue(other.recv(100).startswith(b"HTTP/1.1 200"))
        finally:
            for client in idle:
                client.close()


if __name__ == "__main__":
    unittest.main()
