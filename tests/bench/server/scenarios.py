# SPDX-License-Identifier: Apache-2.0
"""What the server is measured in. Every scenario gets a fresh server and yields rows of a table."""

import dataclasses
import http.client
import json
import socket
import subprocess
import threading
import time

from fleet import address, request


@dataclasses.dataclass
class Row:
    name: str
    value: float
    unit: str
    higher_is_better: bool = True
    note: str = ""


@dataclasses.dataclass
class Bench:
    """What a scenario works with."""

    server: object
    fleet: object
    generator: str
    seconds: float
    capacity: dict  # fixes/s with prior, once measured

    def run(self, *groups, seconds=None):
        """Runs groups of clients; returns their outcomes by name and the server's processor time."""
        plan = {"port": self.server.port, "seconds": seconds or self.seconds, "bodies": self.fleet.images,
                "groups": groups}
        before = self.server.cpu_s()
        done = subprocess.run([self.generator], input=json.dumps(plan), capture_output=True, text=True, check=False)
        if done.returncode:
            raise RuntimeError(done.stderr.strip())
        cpu_s = self.server.cpu_s() - before
        return {group["name"]: group for group in json.loads(done.stdout)["groups"]}, cpu_s


def group(name, connections, interval_s=0.0, repeat=True):
    return {"name": name, "interval_s": interval_s, "repeat": repeat, "connections": connections}


def ok(outcome):
    return outcome["statuses"].get("200", {"count": 0, "p50_ms": 0.0, "p99_ms": 0.0, "max_ms": 0.0})


def refused(outcome):
    """Answers that ask to come again later."""
    return {status: said for status, said in outcome["statuses"].items() if status in ("429", "503")}


def localized_share(outcome):
    return outcome["results"].get("localized", 0) / max(1, ok(outcome)["count"])


def rotated(requests, count):
    """The same requests for each of so many clients, begun at different places."""
    requests = list(requests)
    return [requests[i * len(requests) // count:] + requests[:i * len(requests) // count] for i in range(count)]


# Clients that wait for their answers, however long it takes.
PATIENT_MS = 10_000


def stateless(bench, count, prior, deadline_ms=None):
    return [{"source": address(i), "requests": each}
            for i, each in enumerate(rotated(bench.fleet.localize(prior, deadline_ms), count))]


def saturated(bench):
    """64 connections that send the next image with the answer to the last one."""
    connections = 64
    for name, prior in (("global", False), ("prior", True)):
        outcomes, cpu_s = bench.run(group(name, stateless(bench, connections, prior, PATIENT_MS)))
        fixes = ok(outcomes[name])["count"]
        if prior:
            bench.capacity["prior"] = fixes / bench.seconds
        yield Row(f"saturated, {name} fix", fixes / bench.seconds, "/s",
                  note=f"{100 * localized_share(outcomes[name]):.0f} % localized")
        yield Row(f"saturated, {name} fix, processor", 1e3 * cpu_s / max(1, fixes), "ms", False)
    vehicles = bench.fleet.register_many(connections)
    each = int(100 * bench.seconds / 10)
    outcomes, cpu_s = bench.run(group("vehicle", [
        {"source": address(i), "requests": list(bench.fleet.frames(vehicle, 7 * i, each, 0.2, PATIENT_MS))}
        for i, vehicle in enumerate(vehicles)], repeat=False))
    fixes = ok(outcomes["vehicle"])["count"]
    yield Row("saturated, vehicle frame", fixes / bench.seconds, "/s",
              note=f"{100 * localized_share(outcomes['vehicle']):.0f} % localized")
    yield Row("saturated, vehicle frame, processor", 1e3 * cpu_s / max(1, fixes), "ms", False)


def loaded(bench):
    """Images with a prior at a given rate, whatever the server does."""
    if "prior" not in bench.capacity:
        outcomes, _ = bench.run(group("prior", stateless(bench, 64, True, PATIENT_MS)))
        bench.capacity["prior"] = ok(outcomes["prior"])["count"] / bench.seconds
    for share in (0.9, 3.0):
        connections = 256
        rate = share * bench.capacity["prior"]
        outcomes, _ = bench.run(group("load", stateless(bench, connections, True), interval_s=connections / rate))
        outcome = outcomes["load"]
        name = f"load of {100 * share:.0f} %"
        yield Row(f"{name}, p99 of answered", ok(outcome)["p99_ms"], "ms", False,
                  f"{ok(outcome)['count'] / bench.seconds:.0f}/s")
        if share > 1:
            late = max((said["p99_ms"] for said in refused(outcome).values()), default=0.0)
            count = sum(said["count"] for said in refused(outcome).values())
            yield Row(f"{name}, p99 of refused", late, "ms", False, f"{count / bench.seconds:.0f}/s")


def greedy(bench):
    """20 polite vehicles beside one client that sends as much as it can from many connections."""
    for connections in (60, 200):
        vehicles = bench.fleet.register_many(20)
        polite = [{"source": address(500 + i), "requests": list(bench.fleet.frames(vehicle, 5 * i,
                                                                                   int(2 * bench.seconds) + 2, 0.5))}
                  for i, vehicle in enumerate(vehicles)]
        hog = stateless(bench, connections, False)
        for connection in hog:
            connection["source"] = address(0)
        outcomes, _ = bench.run(group("polite", polite, 0.5, False), group("greedy", hog))
        asked = sum(said["count"] for said in outcomes["polite"]["statuses"].values()) + outcomes["polite"]["unanswered"]
        answered = ok(outcomes["polite"])
        name = f"20 polite vehicles beside {connections} greedy connections"
        yield Row(f"{name}, answered", 100 * answered["count"] / max(1, asked), "%")
        yield Row(f"{name}, p99", answered["p99_ms"], "ms", False)
        for vehicle in vehicles:
            bench.fleet.call("DELETE", f"/v1/vehicles/{vehicle}")


def odometry(bench):
    """500 vehicles send odometry at 10 Hz."""
    vehicles = bench.fleet.register_many(500)
    clients = [{"source": address(i), "requests": list(bench.fleet.odometry(vehicle, i, int(10 * bench.seconds), 0.1))}
               for i, vehicle in enumerate(vehicles)]
    outcomes, cpu_s = bench.run(group("odometry", clients, 0.1, False))
    answered = ok(outcomes["odometry"])
    yield Row("500 vehicles, 10 Hz odometry, processor", cpu_s / bench.seconds, "cores", False,
              f"{answered['count'] / bench.seconds:.0f}/s answered, p99 {answered['p99_ms']:.1f} ms")


def fleet(bench):
    """500 vehicles send odometry at 10 Hz and an image in 5 s; without and with five dashboards."""
    vehicles = bench.fleet.register_many(500)
    seconds = max(10.0, bench.seconds)
    for dashboards in (0, 5):
        clients = [{"source": address(i),
                    "requests": list(bench.fleet.driving(f"{vehicle}", i, seconds, 10, 5))}
                   for i, vehicle in enumerate(vehicles)]
        pages = [{"source": address(600 + i), "requests": [request("GET", "/v1/vehicles")]} for i in range(dashboards)]
        for vehicle in vehicles:  # a drive begins anew
            bench.fleet.call("DELETE", f"/v1/vehicles/{vehicle}")
            bench.fleet.register(vehicle)
        outcomes, cpu_s = bench.run(group("fleet", clients, 0.1, False), group("pages", pages, 1.0), seconds=seconds)
        answered = ok(outcomes["fleet"])
        asked = 10 * len(vehicles) * seconds
        name = f"500 vehicles, odometry and images, {dashboards} dashboards"
        yield Row(f"{name}, answered", 100 * answered["count"] / asked, "%",
                  note=f"{cpu_s / seconds:.2f} cores")
        yield Row(f"{name}, p99", answered["p99_ms"], "ms", False)


def idle_sockets(bench):
    """One address opens 1,024 connections and sends nothing; another one asks."""
    held = []
    try:
        for _ in range(1024):
            connection = socket.socket()
            connection.settimeout(2.0)
            try:
                connection.bind(("127.0.0.1", 0))
                connection.connect(("127.0.0.1", bench.server.port))
            except OSError:
                connection.close()
                break
            held.append(connection)
        time.sleep(0.5)
        answered, slowest_ms = 0, 0.0
        for number in range(10):
            start = time.monotonic()
            try:
                other = http.client.HTTPConnection("127.0.0.1", bench.server.port, timeout=2.0,
                                                   source_address=(address(700 + number), 0))
                other.request("GET", "/readyz")
                answered += other.getresponse().status == 200
                other.close()
            except OSError:
                pass
            slowest_ms = max(slowest_ms, 1e3 * (time.monotonic() - start))
        yield Row(f"another address beside {len(held)} idle connections of one, answered", 10.0 * answered, "%",
                  note=f"slowest {slowest_ms:.0f} ms")
    finally:
        for connection in held:
            connection.close()


def nested_json(bench):
    """Four bodies of 16 MiB of '[' at once, as a part of a multipart body, which needs no token."""
    head = ('--b\r\nContent-Disposition: form-data; name="request"\r\nContent-Type: application/json\r\n\r\n').encode()
    body = head + b"[" * (16 * 2**20 - 4096) + b"\r\n--b--\r\n"
    before = bench.server.memory_mb()
    slowest = []

    def send():
        start = time.monotonic()
        try:
            connection = http.client.HTTPConnection("127.0.0.1", bench.server.port, timeout=60)
            connection.request("POST", f"/v1/maps/{bench.fleet.map}/localize", body,
                               {"Content-Type": "multipart/form-data; boundary=b"})
            connection.getresponse().read()
        except OSError:
            pass  # closed before the whole body was sent
        slowest.append(time.monotonic() - start)

    threads = [threading.Thread(target=send) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    yield Row("4 bodies of 16 MiB of '[', memory", bench.server.memory_mb("VmHWM") - before, "MB", False)
    yield Row("4 bodies of 16 MiB of '[', time", max(slowest), "s", False)


def soak(bench, minutes):
    """100 vehicles, odometry and images, for minutes: the growth of the memory after the first half."""
    vehicles = bench.fleet.register_many(100)
    sizes = []
    for minute in range(minutes):
        clients = [{"source": address(i), "requests": list(bench.fleet.driving(vehicle, i + 600 * minute, 60, 10, 2, 60 * minute))}
                   for i, vehicle in enumerate(vehicles)]
        bench.run(group("fleet", clients, 0.1, False), seconds=60)
        sizes.append(bench.server.memory_mb())
    half = len(sizes) // 2
    yield Row(f"memory, growth in the last {len(sizes) - half} of {minutes} minutes", sizes[-1] - sizes[half - 1], "MB",
              False, f"{sizes[-1]:.0f} MB")


SCENARIOS = {"saturated": saturated, "loaded": loaded, "greedy": greedy, "odometry": odometry, "fleet": fleet,
             "idle": idle_sockets, "json": nested_json}
