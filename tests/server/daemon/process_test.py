#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The real server process: exit codes, signals, a log without a reader. Usage: process_test.py FLOORLOC_SERVER"""

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
import urllib.request

SERVER = sys.argv.pop() if len(sys.argv) > 1 else "floorloc-server"


class ProcessTest(unittest.TestCase):
    def setUp(self):
        self.maps = tempfile.TemporaryDirectory()
        self.addCleanup(self.maps.cleanup)

    def start(self):
        process = subprocess.Popen([SERVER, "--maps", self.maps.name, "--listen", "127.0.0.1:0"], text=True,
                                   stderr=subprocess.PIPE)
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
