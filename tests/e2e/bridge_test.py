#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""floorloc-bridge between the real server and a real mosquitto.
Arguments: floorloc-mapbuilder, floorloc-server, floorloc-bridge."""

import functools
import hashlib
import http.server
import itertools
import json
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "clients/python"))
import openapi  # noqa: E402
import real_server  # noqa: E402
from mqtt_broker import Broker, Listener  # noqa: E402
from vda5050_schemas import V2, V3  # noqa: E402

from floorloc import Client, read_calibration  # noqa: E402

MAPBUILDER, SERVER, BRIDGE = sys.argv[1:4]
del sys.argv[1:4]
ROOT_2, ROOT_3 = "uagv/v2/Acme", "vda5050/v3/Acme"
VEHICLES = ("own", "plain", "newer")
NO_MAP = "0" * 64
FOREIGN_STATE = {"headerId": 77}  # of a vehicle's own client


def quiet_server(folder):
    """A server of files, for downloads."""

    class Handler(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *_):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Handler, directory=str(folder)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return server


class BridgeTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="floorloc-bridge-")))
        maps = real_server.build_map(MAPBUILDER, cls.folder)
        cls.server = real_server.RealServer(SERVER, maps)
        cls.addClassCleanup(lambda: cls.server.stop())
        cls.client = cls.enterClassContext(Client(cls.server.url))
        calibration = read_calibration(real_server.SURVEY)
        cls.vehicles = {name: cls.client.register(name, "hall", **calibration) for name in VEHICLES}
        cls.frames = [file.read_bytes() for _, file in real_server.frames()]
        cls.stamps = itertools.count(time.time())
        cls.broker = Broker(cls.folder)
        cls.addClassCleanup(lambda: cls.broker.stop())
        cls.ids = itertools.count(1)

    def setUp(self):
        self.ear = Listener(self.broker)
        self.addCleanup(self.ear.close)
        config = self.folder / "bridge.json"
        config.write_text(json.dumps({
            "vehicles": [{"id": "own", "manufacturer": "Acme", "serial": "1", "own_state": True},
                         {"id": "plain", "manufacturer": "Acme", "serial": "2"}],
            "broker": {"host": "localhost", "port": self.broker.port, "reconnect_min_s": 0.2},
            "server": {"url": self.server.url}, "lost_after_s": 0.3, "error_hold_s": 5}), encoding="utf-8")
        self.config = config
        self.bridge = self.start_bridge("--config", config)
        self.ear.wait(f"{ROOT_2}/1/connection", lambda data: data["connectionState"] == "ONLINE")

    def start_bridge(self, *options):
        log = open(self.folder / "bridge.log", "a", encoding="utf-8")
        self.addCleanup(log.close)
        bridge = subprocess.Popen([BRIDGE, "mqtt", *options], stderr=log)

        def stop():
            bridge.terminate()
            self.assertIn(bridge.wait(20), (0, -signal.SIGKILL), (self.folder / "bridge.log").read_text("utf-8"))

        self.addCleanup(stop)
        return bridge

    def frame(self, vehicle, index):
        """The vehicle stands where this frame of the survey was taken; the answer to its image."""
        return self.vehicles[vehicle].frame(self.frames[index], f"{next(self.stamps):.3f}")

    def localize(self, vehicle, index):
        """Until the fused pose is there, wherever the vehicle was before."""
        for _ in range(6):
            answer = self.frame(vehicle, index)
            if answer["status"] == "localized" and answer["fix"]["accepted"]:
                return answer["pose"]
        raise AssertionError(answer)

    def act(self, serial, kind, **parameters):
        action = f"action-{next(self.ids)}"
        self.broker.publish(f"{ROOT_2}/{serial}/instantActions", {
            "headerId": 1, "timestamp": "2026-01-01T00:00:00.00Z", "version": "2.1.0", "manufacturer": "Acme",
            "serialNumber": serial,
            "actions": [{"actionType": kind, "actionId": action, "blockingType": "NONE",
                         "actionParameters": [{"key": key, "value": value} for key, value in parameters.items()]}]})
        return action

    def outcome(self, action, *statuses, vehicle="own"):
        """Waits until the action has one of these."""
        found = self.ear.wait(f"floorloc/v1/{vehicle}/actionStates", lambda states: any(
            state["actionId"] == action and state["actionStatus"] in statuses for state in states))
        return next(state for state in found.data if state["actionId"] == action)

    def assert_everything_is_valid(self):
        heard = 0
        for said in self.ear.everything():
            name = said.topic.rsplit("/", 1)[1]
            schemas = V3 if "/v3/" in said.topic or "/newer/" in said.topic else V2
            if name in schemas and said.data != FOREIGN_STATE:
                self.assertEqual(openapi.misfits(schemas[name], said.data), [], said)
                heard += 1
        self.assertGreater(heard, 5)

    def test_positions_come_as_the_version_wants_them(self):
        pose = self.localize("own", 4)
        position = self.ear.wait("floorloc/v1/own/position", lambda data: data["positionInitialized"]).data
        self.assertAlmostEqual(position["x"], pose["x"], delta=1e-6)
        self.assertEqual(position["mapId"], "hall")
        self.assertGreater(position["localizationScore"], 0.99)
        self.assertTrue(0 < position["deviationRange"] < 0.05, position)
        self.ear.wait(f"{ROOT_2}/1/visualization", lambda data: data["agvPosition"]["positionInitialized"])
        state = self.ear.wait(f"{ROOT_2}/1/state", lambda data: data.get("agvPosition", {}).get("positionInitialized")
                              and data["maps"] and not data["errors"]).data
        self.assertEqual([entry["mapStatus"] for entry in state["maps"]].count("ENABLED"), 1)
        self.assert_everything_is_valid()
        self.assertFalse([said for said in self.ear.everything() if said.topic == f"{ROOT_2}/2/state"],
                         "the state of a vehicle with a client of its own is its own affair")

    def test_version_3_has_its_own_names(self):
        bridge = self.start_bridge("--server", self.server.url, "--broker", f"127.0.0.1:{self.broker.port}",
                                   "--vehicle", "newer", "--manufacturer", "Acme", "--vda5050", "3.0")
        self.ear.wait(f"{ROOT_3}/newer/connection", lambda data: data["connectionState"] == "ONLINE")
        self.broker.publish(f"{ROOT_3}/newer/state", FOREIGN_STATE)
        self.localize("newer", 4)
        self.ear.wait(f"{ROOT_3}/newer/visualization", lambda data: data["referenceStateHeaderId"] == 77
                      and data["mobileRobotPosition"]["localized"])
        bridge.kill()
        self.ear.wait(f"{ROOT_3}/newer/connection", lambda data: data["connectionState"] == "CONNECTION_BROKEN")
        self.assert_everything_is_valid()

    def test_the_broker_tells_when_the_bridge_dies_and_that_it_went(self):
        connection = f"{ROOT_2}/1/connection"
        self.bridge.kill()
        self.ear.wait(connection, lambda data: data["connectionState"] == "CONNECTIONBROKEN")
        late = Listener(self.broker)
        self.addCleanup(late.close)
        said = late.wait(connection)
        self.assertEqual((said.retained, said.data["connectionState"]), (True, "CONNECTIONBROKEN"))
        again = self.start_bridge("--config", self.config)
        mark = self.ear.mark()
        self.ear.wait(connection, lambda data: data["connectionState"] == "ONLINE", after=mark - 1)
        again.terminate()
        self.ear.wait(connection, lambda data: data["connectionState"] == "OFFLINE")
        self.assertEqual(again.wait(20), 0)
        time.sleep(0.3)
        self.assertEqual([said.data["connectionState"] for said in self.ear.everything()
                          if said.topic == connection][-1], "OFFLINE", "no last will after a farewell")

    def test_an_initial_pose_is_confirmed_or_contradicted_by_the_next_image(self):
        pose = self.localize("own", 4)
        place = {"x": pose["x"], "y": pose["y"], "theta": pose["yaw"], "mapId": "hall"}
        right = self.act("1", "initPosition", **place)
        self.outcome(right, "RUNNING")
        self.wait_for_the_pose("own", place["x"])
        self.frame("own", 4)
        self.outcome(right, "FINISHED")
        wrong = self.act("1", "initPosition", **{**place, "x": place["x"] + 1.5})
        self.outcome(wrong, "RUNNING")
        self.wait_for_the_pose("own", place["x"] + 1.5)
        self.frame("own", 4)
        self.outcome(wrong, "FAILED")
        self.ear.wait(f"{ROOT_2}/1/state", lambda data: any(
            error["errorReferences"] == [{"referenceKey": "actionId", "referenceValue": wrong}]
            for error in data["errors"]))
        nowhere = self.act("1", "initPosition", **{**place, "mapId": "cellar"})
        self.outcome(nowhere, "FAILED")
        self.ear.wait("floorloc/v1/own/errors", lambda errors: "UNKNOWN_MAP_ID" in [e["errorType"] for e in errors])
        self.assert_everything_is_valid()

    def wait_for_the_pose(self, vehicle, x):
        end = time.monotonic() + 10
        while abs(self.client.get_vehicle(vehicle)["pose"]["x"] - x) > 0.05:
            self.assertLess(time.monotonic(), end)
            time.sleep(0.05)
        time.sleep(0.5)  # until the bridge has asked for the last fix before

    def test_what_is_malformed_is_reported_and_survived(self):
        topic = f"{ROOT_2}/1/instantActions"
        for payload in ("{", b"\xff\xfe", "[" * 5000, '{"actions": 7}', "null", "{}"):
            self.broker.publish(topic, payload)
        self.ear.wait("floorloc/v1/own/errors",
                      lambda errors: "VALIDATION_FAILURE" in [error["errorType"] for error in errors])
        for kind, parameters in (("initPosition", {"x": "far", "y": 0, "theta": 0, "mapId": "hall"}),
                                 ("downloadMap", {"mapId": "../etc", "mapVersion": NO_MAP, "mapDownloadLink": "x"}),
                                 ("dance", {})):
            self.assertTrue(self.outcome(self.act("1", kind, **parameters), "FAILED")["resultDescription"])
        foreign = self.act("2", "dance")
        self.localize("plain", 3)
        self.ear.wait("floorloc/v1/plain/position", lambda data: data["positionInitialized"])
        self.assertNotIn(foreign, json.dumps([said.data for said in self.ear.everything()
                                              if said.topic == "floorloc/v1/plain/actionStates"]),
                         "an action for the vehicle's own client")
        self.assertIsNone(self.bridge.poll())
        self.assert_everything_is_valid()

    def test_a_broker_that_restarts_is_found_again(self):
        self.broker.stop()
        self.broker.start()
        self.ear.close()
        self.ear = Listener(self.broker)
        self.addCleanup(self.ear.close)
        self.ear.wait(f"{ROOT_2}/1/connection", lambda data: data["connectionState"] == "ONLINE")
        self.ear.wait("floorloc/v1/own/maps", lambda maps: maps)
        self.localize("own", 5)
        self.ear.wait("floorloc/v1/own/position", lambda data: data["positionInitialized"])

    def test_maps_are_brought_enabled_and_deleted(self):
        self.localize("own", 4)
        other = self.build_other_map()
        files = quiet_server(other.parent)
        self.addCleanup(files.server_close)
        self.addCleanup(files.shutdown)
        link = f"http://127.0.0.1:{files.server_address[1]}/{other.name}"
        info = subprocess.run([MAPBUILDER, "info", "--json", other], capture_output=True, text=True, check=True).stdout
        version = re.search(r'"content_version": ?"([0-9a-f]{64})"|"version": ?"([0-9a-f]{64})"', info)
        new = {"mapId": "hall", "mapVersion": version.group(1) or version.group(2)}
        old = {"mapId": "hall", "mapVersion": self.client.get_map("hall")["version"]}
        right_hash = hashlib.sha256(other.read_bytes()).hexdigest()
        for bad in ({"mapHash": NO_MAP}, {"mapVersion": NO_MAP}, {"mapDownloadLink": link + "x"},
                    {"mapDownloadLink": "ftp://127.0.0.1/x"}):
            failed = self.act("1", "downloadMap", **{**new, "mapDownloadLink": link, **bad})
            self.outcome(failed, "FAILED")
        self.assertEqual(len(self.client.get_map("hall")["versions"]), 1, "what was not wanted does not stay")
        self.outcome(self.act("1", "downloadMap", **new, mapDownloadLink=link, mapHash=right_hash), "FINISHED")
        self.ear.wait("floorloc/v1/own/maps", lambda maps: {**new, "mapStatus": "DISABLED"} in maps)
        self.outcome(self.act("1", "downloadMap", **new, mapDownloadLink=link), "FAILED")
        self.ear.wait("floorloc/v1/own/errors", lambda errors: "DUPLICATE_MAP" in [e["errorType"] for e in errors])
        self.outcome(self.act("1", "deleteMap", **old), "FAILED")
        self.outcome(self.act("1", "enableMap", **new), "FINISHED")
        maps = self.ear.wait("floorloc/v1/own/maps", lambda maps: {**new, "mapStatus": "ENABLED"} in maps).data
        self.assertEqual([entry["mapStatus"] for entry in maps].count("ENABLED"), 1)
        # Another frame: the vehicle is lost until its next image.
        self.ear.wait("floorloc/v1/own/errors", lambda errors: any(
            error["errorType"] == "LOCALIZATION_ERROR" and error["errorLevel"] == "FATAL" for error in errors))
        lost = self.ear.wait("floorloc/v1/own/position", lambda data: not data["positionInitialized"]).data
        self.assertEqual(lost["localizationScore"], 0)
        self.outcome(self.act("1", "enableMap", **old), "FINISHED")
        self.outcome(self.act("1", "deleteMap", **new), "FINISHED")
        mark = self.ear.mark()
        self.localize("own", 4)
        self.ear.wait("floorloc/v1/own/errors", lambda errors: "LOCALIZATION_ERROR" not in
                      [error["errorType"] for error in errors], after=mark)
        self.assert_everything_is_valid()

    def build_other_map(self):
        """Of fewer frames of the same survey."""
        survey = self.folder / "survey"
        rows = (survey / "frames.csv").read_text(encoding="utf-8").splitlines(keepends=True)
        (survey / "frames.csv").write_text("".join(rows[:-1]), encoding="utf-8")
        out = self.folder / "other"
        out.mkdir()
        subprocess.run([MAPBUILDER, "build", "--survey", survey, "--out", out / "other.floormap", "--no-held-out"],
                       check=True, capture_output=True, timeout=120)
        return out / "other.floormap"

    def test_certificates_and_passwords_are_used(self):
        folder = self.folder / "tls"
        folder.mkdir()

        def made(name, *authority):
            """A certificate of localhost, signed by itself or by the authority."""
            subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes",
                            "-days", "2", "-keyout", folder / f"{name}.key", "-out", folder / f"{name}.pem", "-subj",
                            f"/CN={name}", "-addext", "subjectAltName=DNS:localhost", *authority],
                           check=True, capture_output=True, timeout=20)

        made("authority")
        for name in ("broker", "bridge"):
            made(name, "-CA", folder / "authority.pem", "-CAkey", folder / "authority.key",
                 "-addext", "basicConstraints=critical,CA:FALSE")
        users = folder / "users"
        subprocess.run(["mosquitto_passwd", "-c", "-b", users, "floorloc", "secret"], check=True, timeout=20)
        for file in folder.iterdir():
            file.chmod(0o644)
        (folder / "password").write_text("secret\n", encoding="utf-8")
        (folder / "password").chmod(0o600)
        broker = Broker(folder, f"user root\ncafile {folder}/authority.pem\ncertfile {folder}/broker.pem\n"
                        f"keyfile {folder}/broker.key\nrequire_certificate true\nallow_anonymous false\n"
                        f"password_file {users}\n")
        self.addCleanup(broker.stop)
        config = json.loads(self.config.read_text(encoding="utf-8"))
        config["broker"] = {"host": "localhost", "port": broker.port, "username": "floorloc",
                            "password_file": str(folder / "password"),
                            "tls": {"ca_file": str(folder / "authority.pem"),
                                    "certificate_file": str(folder / "bridge.pem"),
                                    "key_file": str(folder / "bridge.key")}}
        self.config.write_text(json.dumps(config), encoding="utf-8")
        result = subprocess.run([BRIDGE, "mqtt", "--check", "--config", self.config], capture_output=True, text=True,
                                timeout=60, check=False)
        self.assertIn("ok      broker", result.stdout)

    def test_the_check_says_what_would_fail(self):
        def check(*options):
            result = subprocess.run([BRIDGE, "mqtt", "--check", *options], capture_output=True, text=True, timeout=60,
                                    check=False)
            return result.returncode, result.stdout + result.stderr

        good = check("--config", self.config)
        self.assertEqual(good[0], 0, good)
        self.assertIn("ok      broker", good[1])
        code, text = check("--server", self.server.url, "--broker", "127.0.0.1:1", "--vehicle", "nobody",
                           "--manufacturer", "Acme")
        self.assertEqual(code, 1)
        self.assertIn("FAILED  vehicle: nobody is not registered", text)
        self.assertIn("FAILED  broker", text)
        self.assertEqual(check("--vehicle", "own", "--manufacturer", "A/B")[0], 2)


if __name__ == "__main__":
    unittest.main()
