# SPDX-License-Identifier: Apache-2.0
"""A floorloc-server that a benchmark starts, and what it costs."""

import http.client
import os
import pathlib
import signal
import socket
import subprocess
import time


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Server:
    """Context manager: a running server with the maps of a folder."""

    def __init__(self, binary, maps, log):
        self.port = free_port()
        self.log = open(log, "ab")
        for state in pathlib.Path(maps).glob("floorloc-state.*"):  # vehicles of the run before
            state.unlink()
        command = [str(binary), "--maps", str(maps), "--listen", f"127.0.0.1:{self.port}"]
        self.process = subprocess.Popen(command, stdout=self.log, stderr=self.log)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGTERM)
        try:
            self.process.wait(timeout=40)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.log.close()

    def wait_until_ready(self, timeout_s=30):
        deadline = time.monotonic() + timeout_s
        while True:
            try:
                connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=5)
                connection.request("GET", "/readyz")
                if connection.getresponse().status == 200:
                    return
            except OSError:
                pass
            if time.monotonic() > deadline or self.process.poll() is not None:
                raise RuntimeError(f"the server does not start; {self.log.name} says why")
            time.sleep(0.1)

    def cpu_s(self):
        """Processor time of all threads so far."""
        fields = pathlib.Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def memory_mb(self, key="VmRSS"):
        """Resident memory now (VmRSS) or its peak (VmHWM)."""
        for line in pathlib.Path(f"/proc/{self.process.pid}/status").read_text().splitlines():
            if line.startswith(key + ":"):
                return int(line.split()[1]) / 1024
        raise RuntimeError(f"the server has ended; {self.log.name} says why")
