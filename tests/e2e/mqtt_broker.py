# SPDX-License-Identifier: Apache-2.0
"""A mosquitto of its own, and what is said on it."""

import json
import socket
import subprocess
import threading
import time
from typing import Any, NamedTuple


class Said(NamedTuple):
    topic: str
    retained: bool
    data: Any


class Broker:
    def __init__(self, folder, options="allow_anonymous true\n"):
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = probe.getsockname()[1]
        self.config = folder / "mosquitto.conf"
        self.config.write_text(f"listener {self.port} 127.0.0.1\n{options}", encoding="utf-8")
        self.start()

    def start(self):
        self.process = subprocess.Popen(["/usr/sbin/mosquitto", "-c", self.config], stderr=subprocess.DEVNULL)
        end = time.monotonic() + 10
        while True:
            try:
                socket.create_connection(("127.0.0.1", self.port), 1).close()
                return
            except OSError:
                if time.monotonic() > end:
                    raise
                time.sleep(0.02)

    def stop(self):
        self.process.terminate()
        self.process.wait(10)

    def publish(self, topic, payload):
        text = payload if isinstance(payload, (str, bytes)) else json.dumps(payload)
        subprocess.run(["mosquitto_pub", "-p", str(self.port), "-t", topic, "-s"], check=True, timeout=10,
                       input=text if isinstance(text, bytes) else text.encode())


class Listener:
    """Hears everything; waits for what a test wants to hear."""

    def __init__(self, broker):
        self._said = []
        self._news = threading.Condition()
        self._process = subprocess.Popen(["mosquitto_sub", "-p", str(broker.port), "-t", "#", "-F", "%t %r %p"],
                                         stdout=subprocess.PIPE, text=True, errors="replace")
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self):
        for line in self._process.stdout:
            topic, retained, text = line.rstrip("\n").split(" ", 2)
            try:
                said = Said(topic, retained == "1", json.loads(text))
            except (ValueError, RecursionError):
                continue  # what a test sent
            with self._news:
                self._said.append(said)
                self._news.notify_all()

    def everything(self):
        with self._news:
            return list(self._said)

    def mark(self):
        with self._news:
            return len(self._said)

    def wait(self, topic, wanted=lambda data: True, after=0, timeout_s=20):
        """The first message of the topic, not before the mark, that is wanted."""
        end = time.monotonic() + timeout_s
        with self._news:
            while True:
                for said in self._said[after:]:
                    if said.topic == topic and wanted(said.data):
                        return said
                left = end - time.monotonic()
                if left <= 0:
                    latest = [said.data for said in self._said[after:] if said.topic == topic][-3:]
                    raise AssertionError(f"not heard on {topic}; the latest there: {latest}")
                self._news.wait(left)

    def close(self):
        self._process.kill()
        self._process.wait()
        self._process.stdout.close()
