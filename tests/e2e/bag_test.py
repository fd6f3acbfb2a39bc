# SPDX-License-Identifier: Apache-2.0
"""Bags in the place of survey folders, with the real floorloc-mapbuilder: what a bag gives is what its folder gives."""

import json
import unittest

from builder import Scratch, run, run_ok
from ros_bag import write_bag


class Bags(Scratch):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        survey = cls.root / "simulated"
        run_ok("simulate", "--texture", "concrete", "--size", "0.6x0.5", "--floor-seed", "5", "--seed", "1", "--out", survey)
        cls.survey = survey
        cls.bag = cls.root / "hall.db3"
        write_bag(survey, cls.bag)
        cls.folder_of_bag = cls.root / "hall"
        cls.exported = run_ok("export", cls.bag, "--survey", cls.folder_of_bag)
        cls.map = cls.root / "by_bag.floormap"
        cls.built = run_ok("build", "--bag", cls.bag, "--out", cls.map, "--no-held-out")

    def test_images_are_unpacked_byte_by_byte(self):
        names = [line.split(",")[1] for line in (self.survey / "frames.csv").read_text().split()[1:]]
        unpacked = [line.split(",")[1] for line in (self.folder_of_bag / "frames.csv").read_text().split()[1:]]
        self.assertEqual(len(names), len(unpacked))
        for name, other in zip(names, unpacked):
            self.assertEqual((self.survey / name).read_bytes(), (self.folder_of_bag / other).read_bytes())
        self.assertIn(f"{len(names)} images", self.exported)

    def test_the_map_is_that_of_the_unpacked_folder(self):
        other = self.folder / "by_folder.floormap"
        run_ok("build", "--survey", self.folder_of_bag, "--out", other, "--no-held-out")
        first, second = (json.loads(run_ok("info", file, "--json")) for file in [self.map, other])
        self.assertEqual(first["version"], second["version"])
        self.assertEqual(first["surveys"], second["surveys"])
        self.assertEqual(first["keypoints"], second["keypoints"])

    def test_the_report_says_where_the_mounting_came_from(self):
        sentence = "/tf_static base_link -> camera_optical"
        self.assertIn(sentence, self.built)
        self.assertIn(sentence, json.loads(run_ok("info", self.map, "--json"))["surveys"][0]["mounting"])
        self.assertIn("origin: ", (self.folder_of_bag / "floor.yaml").read_text())

    def test_nothing_is_left_beside_the_map(self):
        self.assertEqual([], [file.name for file in self.root.glob("by_bag.floormap.*")])

    def test_drives_are_read_from_bags(self):
        for command in [["localize", "--map", self.map], ["odometry"]]:
            outs = [self.folder / f"{command[0]}_{kind}.tum" for kind in ["bag", "folder"]]
            run_ok(*command, "--bag", self.bag, "--out", outs[0])
            run_ok(*command, "--frames", self.folder_of_bag, "--out", outs[1])
            self.assertEqual(outs[0].read_text(), outs[1].read_text())
            self.assertGreater(len(outs[0].read_text().splitlines()), 3)
        self.assertEqual([], list(self.folder.glob("*.bag")))
        self.assertEqual(2, run("odometry", "--out", outs[0]).returncode)

    def test_info_lists_topics_and_what_is_missing(self):
        text = run_ok("info", self.bag)
        self.assertRegex(text, r"/odom +nav_msgs/Odometry +\d+ +[\d.]+")
        self.assertIn("build --bag and export --survey can use it as it is", text)
        bare = self.folder / "bare.db3"
        write_bag(self.survey, bare, with_mounting=False)
        info = json.loads(run_ok("info", bare, "--json"))
        self.assertFalse(info["survey"]["possible"])
        self.assertIn("--floor floor.yaml", info["survey"]["missing"][0])
        refused = run("build", "--bag", bare, "--out", self.folder / "a.floormap")
        self.assertEqual(1, refused.returncode)
        self.assertIn("bare.db3: nothing says how the camera hangs", refused.stderr)
        self.assertEqual(["bare.db3"], [file.name for file in self.folder.iterdir()])
        run_ok("export", bare, "--survey", self.folder / "bare", "--floor", self.survey / "floor.yaml")

    def test_a_bag_that_was_cut_off_is_read_as_far_as_it_goes(self):
        cut = self.folder / "cut.db3"
        cut.write_bytes(self.bag.read_bytes()[:-200_000])
        result = run("export", cut, "--survey", self.folder / "cut")
        self.assertEqual(0, result.returncode, result.stderr)
        self.assertIn("is damaged after", result.stdout)

    def stamps_of(self, name, image_stamp):
        """Unpacks a bag whose images have these stamps: the time stamps of frames.csv, and what was printed."""
        bag = self.folder / f"{name}.db3"
        write_bag(self.survey, bag, image_stamp=image_stamp)
        printed = run_ok("export", bag, "--survey", self.folder / name)
        return [line.split(",")[0] for line in (self.folder / name / "frames.csv").read_text().split()[1:]], printed

    def test_headers_without_stamps_count_as_recorded(self):
        recorded, _ = self.stamps_of("recorded", lambda number, stamp_ns: stamp_ns)
        stamps, printed = self.stamps_of("unstamped", lambda number, stamp_ns: 0)
        self.assertEqual(stamps, recorded)
        self.assertIn("have no stamps; those of recording are used", printed)
        stamps, printed = self.stamps_of("some", lambda number, stamp_ns: 0 if number in (2, 3) else stamp_ns)
        self.assertEqual(stamps, recorded[:2] + recorded[4:])
        self.assertIn("images: left out 2 without a stamp", printed)

    def test_simulated_time_may_begin_at_0_and_stamps_may_repeat(self):
        stamps, printed = self.stamps_of("simulated", lambda number, _: number * 250_000_000)
        self.assertEqual(stamps[:3], ["0.000000000", "0.250000000", "0.500000000"])
        self.assertNotIn("warning", printed)
        stamps, printed = self.stamps_of("repeated", lambda number, _: (number - number % 2 + 1) * 10**9)
        self.assertEqual(stamps[:2], ["1.000000000", "3.000000000"])
        self.assertIn("with the stamp of another one", printed)

    def test_wrong_uses_say_what_to_do(self):
        for arguments, sentence in [
                (["export", self.bag], "is a bag; give --survey DIR"),
                (["export", self.map, "--survey", self.folder / "a"], "is no bag, which --survey unpacks"),
                (["build", "--bag", self.map, "--out", self.folder / "b"], "is no rosbag2"),
                (["build", "--bag", self.bag, "--image-topic", "/b", "--out", self.folder / "c"], "has no topic /b of images")]:
            result = run(*arguments)
            self.assertEqual(1, result.returncode, arguments)
            self.assertIn(sentence, result.stderr)
            self.assertEqual(1, len(result.stderr.splitlines()), result.stderr)


if __name__ == "__main__":
    unittest.main()
