#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of the demo's vehicle that need no server."""

import argparse
import contextlib
import io
import math
import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "maps"))
import vehicle  # noqa: E402


def answer(time_s, status="localized", pose=(0j, 0.0), fix=None):
    return vehicle.Answer(time_s, status, pose, 1.0, fix)


class MessagesTest(unittest.TestCase):
    def test_motion_is_given_in_the_frame_of_its_start(self):
        dx, dy, dyaw = vehicle.motion_between((1 + 1j, math.pi / 2), (1 + 3j, -math.pi + 0.1))
        self.assertAlmostEqual(dx, 2)
        self.assertAlmostEqual(dy, 0)
        self.assertAlmostEqual(dyaw, math.pi / 2 + 0.1)

    def test_odometry_and_frames_come_in_the_order_of_time(self):
        folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        (folder / "frames.csv").write_text("timestamp,filename\n10.0,a.jpg\n10.03,b.jpg\n")
        rows = [f"{10 + 0.02 * i:.2f} {i} 0 0 0 0 0 1" for i in range(4)]
        (folder / "odometry.tum").write_text("\n".join(rows) + "\n")
        messages = vehicle.read_messages(folder)
        self.assertEqual([message.image_file.name if message.image_file else round(message.motion[0], 3)
                          for message in messages],
                         ["a.jpg", 1, 0.5, "b.jpg", 0.5, 1])
        self.assertEqual(messages[0].stamp, "10.0")
        self.assertEqual(vehicle.read_kidnaps(folder), [])

    def test_kidnaps_are_read_among_other_events(self):
        folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        (folder / "events.csv").write_text("timestamp,duration,event\n1.5,0.2,slip\n7.1,0,kidnap\n14,0,kidnap\n")
        self.assertEqual(vehicle.read_kidnaps(folder), [7.1, 14.0])


class StubClient:
    """Fake server: answers with the pose integrated from the odometry sent so far."""

    def __init__(self):
        self.calls = []
        self.x = 0.0

    def delete_vehicle(self, vehicle_name):
        self.calls.append(("DELETE", vehicle_name))

    def put_vehicle(self, vehicle_name, registration):
        self.calls.append(("PUT", vehicle_name, registration["map"]))

    def post_odometry(self, vehicle_name, increments):
        self.calls.append(("odometry", vehicle_name, [increment["stamp"] for increment in increments]))
        self.x += sum(increment["dx"] for increment in increments)
        return {"status": "localized", "pose": {"x": self.x, "y": 0.0, "yaw": 0.0}}

    def post_frame(self, vehicle_name, image, stamp):
        self.calls.append(("frame", vehicle_name, stamp, image))
        return {"status": "localized", "pose": {"x": self.x, "y": 0.0, "yaw": 0.0}, "fix": {"accepted": True}}


class RunTest(unittest.TestCase):
    def test_everything_is_sent_to_the_vehicle_and_answered(self):
        folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        (folder / "a.jpg").write_bytes(b"\xff\xd8picture")
        (folder / "camera.yaml").write_text("image_width: 640\n")
        (folder / "floor.yaml").write_text("resolution: 0.0007\n")
        (folder / "frames.csv").write_text("timestamp,filename\n10.02,a.jpg\n")
        (folder / "odometry.tum").write_text("".join(f"{10 + 0.02 * i:.2f} {3 * i} 0 0 0 0 0 1\n" for i in range(3)))
        client = StubClient()
        arguments = argparse.Namespace(frames=folder, vehicle="v", map="hall", pace=0.0)
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            answers = vehicle.run(client, arguments)
        self.assertEqual(client.calls, [
            ("DELETE", "v"), ("PUT", "v", "hall"), ("odometry", "v", ["10.020000"]),
            ("frame", "v", "10.02", b"\xff\xd8picture"), ("odometry", "v", ["10.040000"])])
        self.assertEqual([answer.pose[0].real for answer in answers], [3, 3, 6])
        self.assertEqual([answer.fix is None for answer in answers], [True, False, True])
        self.assertIn("localized", printed.getvalue())


class EvaluationTest(unittest.TestCase):
    def judged(self):
        """A kidnap at 10 s: two answers before the next image, three uncertain ones, then relocalized."""
        answers = [answer(9.9), answer(10.02), answer(10.04),
                   answer(10.1, "tracking_odometry", fix={"accepted": False}),
                   answer(10.2, "tracking_odometry"),
                   answer(10.3, "tracking_odometry", fix={"accepted": False}),
                   answer(10.5, "localized", fix={"accepted": True}), answer(10.6)]
        return [(a, 1.0 if 10 <= a.time_s < 10.5 else 0.001, 0.0) for a in answers]

    def test_follows_a_kidnap_from_notice_to_recovery(self):
        [kidnap] = vehicle.follow_kidnaps([10.0], self.judged())
        self.assertAlmostEqual(kidnap.noticed_s, 0.1)
        self.assertAlmostEqual(kidnap.found_s, 0.5)
        self.assertEqual(kidnap.frames, 3)

    def test_a_vehicle_that_stays_lost_is_reported(self):
        [kidnap] = vehicle.follow_kidnaps([10.0], self.judged()[:6])
        self.assertIsNone(kidnap.found_s)
        self.assertEqual(len(vehicle.problems(0, 1.0, [kidnap])), 1)

    def test_only_wrong_poses_after_an_image_count(self):
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            answers = [a for a, _, _ in self.judged()]
            self.assertEqual(vehicle.report(answers, self.judged(), []), [
                "only 62.5 % of the answers are localized, 80 % are expected"])
            after_image = [(answer(9.0, fix={"accepted": True}), 0.2, 0.0)] + self.judged()
            self.assertEqual(len(vehicle.report(answers, after_image, [])), 2)
        self.assertIn("2 of 4 wrong", printed.getvalue())

    def test_wrong_and_rare_poses_are_reported(self):
        self.assertEqual(vehicle.problems(0, 0.9, []), [])
        self.assertEqual(len(vehicle.problems(3, 0.1, [])), 2)

    def test_errors_do_not_depend_on_the_frames_of_map_and_truth(self):
        times = [0.1 * i for i in range(20)]
        truth = (times, [(complex(t, t * t), t) for t in times])
        answers = [answer(t, pose=(complex(t, t * t) * 1j + 3, t + math.pi / 2), fix={"accepted": True}) for t in times]
        for _, position_m, yaw_rad in vehicle.judge(answers, truth):
            self.assertLess(position_m, 1e-9)
            self.assertLess(yaw_rad, 1e-9)


if __name__ == "__main__":
    unittest.main()
