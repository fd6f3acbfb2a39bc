#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of the requests that the server's benchmark makes."""

import itertools
import json
import re
import unittest

from fleet import Fleet
from scenarios import localized_share, ok, refused, rotated


class FleetTest(unittest.TestCase):
    def setUp(self):
        self.fleet = Fleet.__new__(Fleet)
        self.fleet.map = "hall"
        self.fleet.images = ["a", "b", "c"]
        self.fleet.poses = [(0j, 0.0), (1 + 0j, 1.5), (1 + 2j, 1.5)]

    def test_drives_to_the_end_and_back(self):
        self.assertEqual(list(itertools.islice(self.fleet.way(0), 7)), [0, 1, 2, 1, 0, 1, 2])
        self.assertEqual(list(itertools.islice(self.fleet.way(7), 3)), [1, 0, 1])

    def test_motions_lead_from_pose_to_pose(self):
        self.assertEqual(self.fleet.motion(0, 1), (1.0, 0.0, 1.5))
        there, back = self.fleet.motion(1, 2), self.fleet.motion(2, 1)
        for value, opposite in zip(there[:2], back[:2]):
            self.assertAlmostEqual(value, -opposite)

    def test_an_image_takes_the_place_of_an_increment(self):
        requests = list(self.fleet.driving("v", 0, seconds=2, odometry_hz=10, frame_every_s=1, begin_s=60))
        frames = [i for i, request in enumerate(requests) if "/frames?" in request["head"]]
        self.assertEqual((len(requests), frames), (20, [9, 19]))
        stamps = [json.loads(r["text"])["stamp"] if "text" in r else float(re.search(r"stamp=([\d.]+)", r["head"])[1])
                  for r in requests]
        for before, after in zip(stamps, stamps[1:]):
            self.assertAlmostEqual(after - before, 0.1, places=2)

    def test_clients_begin_at_different_places(self):
        self.assertEqual(rotated("abcd", 2), [list("abcd"), list("cdab")])


class OutcomeTest(unittest.TestCase):
    def test_shares(self):
        outcome = {"statuses": {"200": {"count": 4}, "429": {"count": 2}, "400": {"count": 1}},
                   "results": {"localized": 3}}
        self.assertEqual(localized_share(outcome), 0.75)
        self.assertEqual(list(refused(outcome)), ["429"])
        self.assertEqual(ok({"statuses": {}})["count"], 0)


if __name__ == "__main__":
    unittest.main()
