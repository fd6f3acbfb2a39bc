#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The Python client against a server that answers as it is told: retries, deadlines, connections, events, batches."""

import datetime
import email.utils
import json
import math
import pickle
import threading
import time
import unittest
import unittest.mock

from fake_server import FakeServer, answer, hang_up, problem

import floorloc
from floorloc import Client, FloorlocError, Retry, ros
from floorloc.events import EventParser
from floorloc.retry import parse_retry_after

JPEG = b"\xff\xd8image"
TRACKED = {"status": "localized", "next": {"seconds": 1.0, "metres": 0.25}}


class ClientCase(unittest.TestCase):
    def serve(self, *script, **options):
        server = FakeServer(*script, **options)
        self.addCleanup(server.stop)
        return server

    def client(self, server, **options):
        client = Client(server.url, **{"timeout_s": 5.0, **options})
        self.addCleanup(client.close)
        return client

    def assert_fails(self, reason, call, *arguments, **options):
        with self.assertRaises(FloorlocError) as caught:
            call(*arguments, **options)
        self.assertEqual(caught.exception.reason, reason, caught.exception)
        return caught.exception


class CallTest(ClientCase):
    def test_requests_are_those_of_the_document(self):
        server = self.serve()
        client = self.client(server, token="secret")
        client.localize("hall", JPEG, vehicle="agv7", prior=(1, 0.5, -2), radius=0.3, twist=(0, 0, 0), stamp="1.5")
        client.post_frame("agv7", b"\x89PNG", 1700000000.25, odometry=(0, 0, 0))
        client.post_initial_pose("agv7", 1, 2, 3, covariance=range(9))
        client.get_ros_vehicle("a/b")
        client.list_fixes("hall", since=7)
        targets = [f"{asked.method} {asked.target}" for asked in server.asked]
        self.assertEqual(targets, [
            "POST /v1/maps/hall/localize?vehicle=agv7&prior=1.0%2C0.5%2C-2.0&radius=0.3&twist=0.0%2C0.0%2C0.0"
            "&stamp=1.5",
            "POST /v1/vehicles/agv7/frames?stamp=1700000000.25&odometry=0.0%2C0.0%2C0.0",
            "POST /v1/vehicles/agv7/initialpose", "GET /v1/vehicles/a%2Fb?format=ros",
            "GET /v1/maps/hall/fixes?since=7"])
        self.assertEqual([asked.headers.get("Content-Type") for asked in server.asked],
                         ["image/jpeg", "image/png", "application/json", None, None])
        self.assertEqual({asked.headers["Authorization"] for asked in server.asked}, {"Bearer secret"})
        self.assertEqual({asked.connection for asked in server.asked}, {1}, "one connection for all")
        self.assertEqual(server.asked[0].body, JPEG)
        self.assertEqual(json.loads(server.asked[2].body), {"x": 1, "y": 2, "yaw": 3, "covariance": list(range(9))})
        self.assertNotIn("X-Deadline-Ms", server.asked[0].headers)

    def test_an_error_has_what_the_server_said(self):
        server = self.serve(problem(422, "unknown_map", X_Request_Id="r1"), answer(502, b"<html>Bad Gateway"))
        error = self.assert_fails("unknown_map", self.client(server).list_maps)
        self.assertEqual((error.status, error.detail, error.request_id), (422, "Because of unknown_map.", "r1"))
        self.assertEqual(str(error), "422 unknown_map: Because of unknown_map.")
        self.assertEqual(vars(pickle.loads(pickle.dumps(error))), vars(error))
        error = self.assert_fails("malformed_answer", self.client(server).list_maps)
        self.assertEqual(error.status, 502)
        self.assertIn("<html>Bad Gateway", error.detail)

    def test_what_is_no_image_or_no_address_is_refused_before_it_is_sent(self):
        server = self.serve()
        with self.assertRaisesRegex(ValueError, "neither a JPEG nor a PNG"):
            self.client(server).post_frame("agv7", b"raw pixels", 1)
        for url in ("localhost:8080", "ftp://host", "http://host/api"):
            with self.assertRaisesRegex(ValueError, "no address"):
                Client(url)
        self.assertEqual(server.asked, [])


class RetryTest(ClientCase):
    def slept(self):
        """The waits of the client, which it does not wait."""
        return self.enterContext(unittest.mock.patch("floorloc.client.time.sleep"))

    def test_overload_is_waited_out_as_the_server_says(self):
        sleep = self.slept()
        server = self.serve(problem(429, "rate_limited", Retry_After="1"), problem(503, "queue_full", Retry_After="2"))
        self.assertEqual(self.client(server).list_maps(), {})
        first, second = (call.args[0] for call in sleep.call_args_list)
        self.assertTrue(1.0 <= first <= 1.25 and 2.0 <= second <= 2.5, (first, second))

    def test_attempts_and_waits_are_bounded(self):
        sleep = self.slept()
        server = self.serve(*[problem(503, "queue_full", Retry_After="1")] * 9)
        error = self.assert_fails("queue_full", self.client(server).list_maps)
        self.assertEqual((error.status, error.retry_after_s, len(server.asked)), (503, 1.0, 3))
        self.assert_fails("queue_full", self.client(server, retry=Retry(attempts=1)).list_maps)
        self.assertEqual(len(server.asked), 4)
        sleep.reset_mock()
        server.script = [problem(503, "draining", Retry_After="60")]
        self.assert_fails("draining", self.client(server, timeout_s=100).list_maps)
        server.script = [problem(503, "queue_full", Retry_After="3")]
        self.assert_fails("queue_full", self.client(server, timeout_s=2).list_maps)
        sleep.assert_not_called()

    def test_what_another_attempt_would_not_change_is_not_tried_again(self):
        for status, code in ((404, "unknown_map"), (503, "replaced"), (503, "no_maps"), (500, "map_damaged")):
            server = self.serve(problem(status, code))
            self.assert_fails(code, self.client(server).list_maps)
            self.assertEqual(len(server.asked), 1, code)

    def test_dates_of_proxies_are_understood(self):
        at = datetime.datetime.now(datetime.timezone.utc) + datetime.timedelta(seconds=100)
        self.assertAlmostEqual(parse_retry_after(email.utils.format_datetime(at, usegmt=True)), 100, delta=3)
        self.assertEqual([parse_retry_after(text) for text in (None, "7", "soon", "-1")], [None, 7.0, None, None])

    def test_a_lost_answer_is_asked_for_again_unless_it_would_be_done_twice(self):
        self.slept()
        server = self.serve(hang_up, hang_up)
        self.assertEqual(self.client(server).list_maps(), {})
        self.assertEqual(len(server.asked), 3)
        server = self.serve(hang_up)
        self.assert_fails("unreachable", self.client(server).call, "POST", "/v1/maps/a/versions/previous/activate",
                          repeatable=False)
        self.assertEqual(len(server.asked), 1)


class DeadlineTest(ClientCase):
    def test_the_server_is_told_what_is_left(self):
        server = self.serve(answer(), problem(503, "queue_full", Retry_After="0"), answer())
        client = self.client(server)
        client.post_frame("agv7", JPEG, 1, deadline_s=0.9)
        client.localize("hall", JPEG, vehicle="agv7", deadline_s=1000)
        told = [int(asked.headers["X-Deadline-Ms"]) for asked in server.asked]
        self.assertEqual(len(told), 3)
        self.assertTrue(800 < told[0] < 900, told)
        self.assertEqual(told[1:], [60000, 60000])

    def test_a_late_answer_is_given_up_and_the_next_call_gets_its_own(self):
        late = threading.Event()
        self.addCleanup(late.set)
        server = self.serve(lambda: late.wait(5) and answer(body={"late": True}), answer(body={"late": False}))
        client = self.client(server)
        error = self.assert_fails("deadline_exceeded", client.post_frame, "agv7", JPEG, 1, deadline_s=0.1)
        self.assertIsNone(error.status)
        self.assertIn("within 0.1 s", error.detail)
        self.assertEqual(client.list_maps(), {"late": False})

    def test_an_answer_that_trickles_is_given_up(self):
        import socket
        listener = socket.create_server(("127.0.0.1", 0))
        self.addCleanup(listener.close)
        stop = threading.Event()

        def trickle():
            connection, _ = listener.accept()
            with connection:
                connection.sendall(b"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nContent-Length: 1000\r\n\r\n")
                while not stop.wait(0.02):
                    connection.sendall(b" ")

        thread = threading.Thread(target=trickle, daemon=True)
        thread.start()
        client = Client(f"http://127.0.0.1:{listener.getsockname()[1]}")
        self.assert_fails("deadline_exceeded", client.call, "GET", "/v1/maps", deadline_s=0.2)
        stop.set()

    def test_threads_share_a_client_and_wait_no_longer_than_they_may(self):
        hold = threading.Event()
        server = self.serve(lambda: hold.wait(5) and answer(), answer())
        client = self.client(server)
        first = threading.Thread(target=client.list_maps)
        first.start()
        while not server.asked:
            time.sleep(0.005)
        self.assert_fails("deadline_exceeded", client.call, "GET", "/v1/maps", deadline_s=0.05)
        hold.set()
        first.join()
        self.assertEqual(client.list_maps(), {})
        self.assertEqual({asked.connection for asked in server.asked}, {1})


class ConnectionTest(ClientCase):
    def test_a_restarted_server_is_found_again_without_an_error(self):
        server = self.serve()
        client = self.client(server, retry=Retry(attempts=1))
        client.list_maps()
        server.stop()
        again = self.serve(port=server.server_address[1])
        self.assertEqual(client.call("POST", "/v1/maps/a/versions/previous/activate", repeatable=False), {})
        self.assertEqual(len(again.asked), 1)

    def test_a_connection_that_closes_under_a_request_is_opened_again(self):
        server = self.serve(answer(), hang_up)
        client = self.client(server, retry=Retry(attempts=1))
        client.list_maps()
        self.assertEqual(client.list_maps(), {})
        self.assertEqual([asked.connection for asked in server.asked], [1, 1, 2])

    def test_connection_close_is_respected(self):
        server = self.serve(answer(Connection="close"))
        client = self.client(server)
        client.list_maps()
        client.list_maps()
        self.assertEqual([asked.connection for asked in server.asked], [1, 2])

    def test_no_server_is_said_so(self):
        server = FakeServer()
        server.stop()
        client = self.client(server, retry=Retry(first_wait_s=0.001))
        error = self.assert_fails("unreachable", client.list_maps)
        self.assertIn(server.url, error.detail)
        self.assertFalse(client.is_ready())
        self.assert_fails("deadline_exceeded", client.wait_until_ready, 0.05)


def stream(*events, retry_ms=1):
    text = "".join(f"id: {id}\nevent: pose\ndata: {json.dumps({'n': id})}\n\n" for id in events)
    half = ": half an event follows\n\nid: 99\nevent: pose\ndata: {"
    return answer(200, f"retry: {retry_ms}\n\n{text}{half}".encode(), Content_Type="text/event-stream",
                  Connection="close")


class EventsTest(ClientCase):
    def test_goes_on_after_the_last_event_when_the_connection_broke(self):
        server = self.serve(stream(5, 6), problem(503, "too_many_streams", Retry_After="0"), hang_up, stream(7))
        events = self.client(server, token="secret").stream_events(vehicle="agv7", types=["pose", "status"])
        got = [next(events) for _ in range(3)]
        events.close()
        self.assertEqual([(event.type, event.data["n"], event.id) for event in got],
                         [("pose", 5, "5"), ("pose", 6, "6"), ("pose", 7, "7")])
        self.assertEqual([asked.headers.get("Last-Event-ID") for asked in server.asked], [None, "6", "6", "6"])
        self.assertEqual({asked.target for asked in server.asked}, {"/v1/events?vehicle=agv7&types=pose%2Cstatus"})
        self.assertEqual({asked.headers["Authorization"] for asked in server.asked}, {"Bearer secret"})

    def test_gives_up_what_is_wrong_at_once_and_what_does_not_answer_in_the_end(self):
        server = self.serve(problem(401, "unauthorized"), hang_up)
        error = self.assert_fails("unauthorized", next, self.client(server).stream_events())
        self.assertEqual(error.status, 401)
        self.assert_fails("unreachable", next, self.client(server).stream_events(patience_s=0.0))

    def test_lines_are_read_as_the_standard_says(self):
        parser = EventParser()
        lines = [": comment", "event:map", 'data: {"a":', "data:1}", "id: 12", "unknown: x", "", "", "event: gap",
                 "data: {}", "", "id", "retry: 2500", ""]
        events = [event for event in map(parser.feed, lines) if event]
        self.assertEqual(events, [("map", {"a": 1}, "12"), ("gap", {}, "12")])
        self.assertEqual((parser.last_id, parser.retry_s), ("", 2.5))


class VehicleTest(ClientCase):
    def vehicle(self, server, **options):
        vehicle = self.client(server).register("agv7", "hall", {"image_width": 640}, {}, **options)
        server.asked.clear()
        return vehicle

    def tracked(self, *more):
        return self.serve(answer(201), *[answer(body=TRACKED)] * 5, *more)

    def test_registers_what_it_is_given(self):
        server = self.serve()
        self.client(server).register("agv7", "hall", {"image_width": 640}, {}, mask="UE5H", correct_camera=False)
        self.assertEqual((server.asked[0].method, server.asked[0].target), ("PUT", "/v1/vehicles/agv7"))
        self.assertEqual(json.loads(server.asked[0].body), {"map": "hall", "camera": {"image_width": 640}, "floor": {},
                                                            "mask": "UE5H", "correct_camera": False})

    def test_odometry_is_sent_in_batches_and_before_an_image(self):
        server = self.tracked()
        vehicle = self.vehicle(server)
        answers = [vehicle.move(10 + 0.02 * i, 0.01, 0, 0) for i in range(8)]
        self.assertEqual([said is not None for said in answers], [False] * 5 + [True] + [False] * 2)
        vehicle.frame(JPEG, 10.15)
        self.assertEqual([asked.target for asked in server.asked],
                         ["/v1/vehicles/agv7/odometry"] * 2 + ["/v1/vehicles/agv7/frames?stamp=10.15"])
        batches = [json.loads(asked.body)["increments"] for asked in server.asked[:2]]
        self.assertEqual([len(batch) for batch in batches], [6, 2])
        self.assertEqual(batches[0][1], {"stamp": 10.02, "dx": 0.01, "dy": 0, "dyaw": 0})
        self.assertEqual(vehicle.pending, 0)

    def test_odometry_that_could_not_be_sent_comes_with_the_next(self):
        server = self.serve(answer(201), problem(500, "internal_error"), *[answer(body=TRACKED)] * 2)
        vehicle = self.vehicle(server)
        vehicle.move(10.0, 1, 0, 0)
        with self.assertRaises(FloorlocError):
            vehicle.move(10.1, 2, 0, 0)
        self.assertEqual(vehicle.pending, 2)
        vehicle.move(10.2, 3, 0, 0)
        self.assertEqual([one["dx"] for one in json.loads(server.asked[-1].body)["increments"]], [1, 2, 3])
        with self.assertRaises(ValueError):
            vehicle.move(10.3, math.nan, 0, 0)

    def test_a_server_that_is_away_for_long_gets_the_same_motion_in_fewer_increments(self):
        server = self.tracked()
        vehicle = self.vehicle(server)
        vehicle.batch_s = math.inf
        for i in range(1005):
            vehicle.move(float(i), 0.1, 0.0, 0.5)
        vehicle.flush()
        increments = json.loads(server.asked[-1].body)["increments"]
        self.assertEqual((len(increments), increments[0]["stamp"], increments[-1]["stamp"]), (1000, 5.0, 1004.0))
        expected = ros.Planar(0, 0, 0)
        for _ in range(6):
            expected = expected * ros.Planar(0.1, 0, 0.5)
        for key, value in zip(("dx", "dy", "dyaw"), expected):
            self.assertAlmostEqual(increments[0][key], value)

    def test_says_when_the_server_wants_the_next_image(self):
        server = self.tracked()
        vehicle = self.vehicle(server)
        self.assertTrue(vehicle.wants_frame(10.0), "none was sent yet")
        vehicle.frame(JPEG, 10.0)
        self.assertFalse(vehicle.wants_frame(10.9))
        self.assertTrue(vehicle.wants_frame(11.0), "a second is over")
        vehicle.batch_s = math.inf
        vehicle.move(10.1, 0.2, 0, 0)
        self.assertFalse(vehicle.wants_frame(10.1))
        vehicle.move(10.2, 0.06, 0, 0)
        self.assertTrue(vehicle.wants_frame(10.2), "a quarter of a metre was driven")
        vehicle.frame(JPEG, 10.3)
        self.assertFalse(vehicle.wants_frame(10.3))
        vehicle.initial_pose(0, 0, 0)
        self.assertTrue(vehicle.wants_frame(10.3))

    def test_registers_again_when_the_server_has_forgotten_it(self):
        server = self.serve(answer(201), problem(404, "unknown_vehicle"), answer(201), answer(body=TRACKED))
        self.assertEqual(self.vehicle(server).frame(JPEG, 1), TRACKED)
        self.assertEqual([asked.method for asked in server.asked], ["POST", "PUT", "POST"])

    def test_removing_says_whether_there_was_one(self):
        server = self.serve(answer(201), answer(204), problem(404, "unknown_vehicle"), problem(403, "forbidden"))
        vehicle = self.vehicle(server)
        self.assertEqual((vehicle.remove(), vehicle.remove()), (True, False))
        self.assert_fails("forbidden", vehicle.remove)


class PlanarTest(unittest.TestCase):
    def test_transforms_form_a_group(self):
        a, b = ros.Planar(1, 2, 3), ros.Planar(-0.5, 0.25, -2)
        for value in a * a.inverse():
            self.assertAlmostEqual(value, 0.0)
        for value, same in zip((a * b) * b.inverse(), a):
            self.assertAlmostEqual(value, same)

    def test_stamps_keep_their_nanoseconds(self):
        self.assertEqual(ros.header("1700000000.123456789", "map")["stamp"], {"sec": 1700000000, "nanosec": 123456789})
        self.assertEqual(ros.header(-0.25, "map")["stamp"], {"sec": -1, "nanosec": 750000000})


if __name__ == "__main__":
    assert floorloc
    unittest.main()
