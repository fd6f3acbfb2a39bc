# SPDX-License-Identifier: Apache-2.0
"""Builds of the real floorloc-mapbuilder that are killed and resumed."""

import json
import random
import shutil
import subprocess
import unittest

from builder import BINARY, Scratch, run, run_ok

FRAMES = 28


class Resumed(Scratch):
    """One small survey, whose builds are killed at a certain line of their progress."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.survey = cls.root / "survey"
        cls.whole = cls.root / "whole.floormap"
        run_ok("simulate", "--texture", "concrete", "--size", "1.2x0.9", "--floor-seed", "5", "--out", cls.survey)
        result = run("build", "--survey", cls.survey, "--out", cls.whole, "--json")
        cls.version = json.loads(result.stdout)["content_version"]
        cls.lines = result.stderr.splitlines()

    def setUp(self):
        super().setUp()
        self.out = self.folder / "m.floormap"
        self.journal = self.folder / "m.floormap.journal"

    def build(self, *arguments):
        result = run("build", "--survey", self.survey, "--out", self.out, "--json", *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout), result.stderr

    def kill_after(self, lines, *arguments):
        """Kills a build after this many lines of progress; False when it finished earlier."""
        command = [BINARY, "build", "--survey", str(self.survey), "--out", str(self.out), *arguments]
        with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as build:
            for _ in range(lines):
                build.stderr.readline()
            build.kill()
            build.stderr.close()
            return build.wait() != 0

    def lines_until(self, stage):
        return 1 + next(i for i, line in enumerate(self.lines) if line.startswith(stage))

    def test_a_killed_build_is_resumed(self):
        self.assertTrue(self.kill_after(self.lines_until("mosaic")))
        self.assertTrue(self.journal.exists())
        report, _ = self.build("--resume")
        self.assertEqual(report["content_version"], self.version)
        self.assertEqual(report["resumed_frames"], FRAMES)
        self.assertEqual([file.name for file in self.folder.iterdir()], ["m.floormap"])
        run_ok("verify", self.out)

    def test_killed_again_and_again_the_map_is_the_same_and_the_old_one_whole(self):
        draw = random.Random(1)
        shutil.copy(self.whole, self.out)
        for _ in range(8):
            self.kill_after(draw.randrange(len(self.lines)), "--resume")
            run_ok("verify", self.out)
            self.assertEqual(json.loads(run_ok("info", self.out, "--json"))["version"], self.version)
        report, _ = self.build("--resume")
        self.assertEqual(report["content_version"], self.version)
        self.assertEqual([file.name for file in self.folder.iterdir()], ["m.floormap"])

    def test_without_resume_everything_is_done_again(self):
        self.assertTrue(self.kill_after(self.lines_until("mosaic")))
        report, _ = self.build()
        self.assertEqual(report["resumed_frames"], 0)
        self.assertEqual(report["content_version"], self.version)
        self.assertFalse(self.journal.exists())

    def test_what_other_options_need_is_done_again(self):
        self.assertTrue(self.kill_after(self.lines_until("mosaic")))
        report, _ = self.build("--resume", "--max-keypoints", "300")
        self.assertEqual(report["resumed_frames"], 0)
        fresh = self.folder / "fresh.floormap"
        other = json.loads(run_ok("build", "--survey", self.survey, "--out", fresh, "--json", "--max-keypoints", "300"))
        self.assertEqual(report["content_version"], other["content_version"])

    def test_what_was_changed_since_is_done_again(self):
        copy = self.folder / "copy"
        shutil.copytree(self.survey, copy)
        self.survey = copy
        self.assertTrue(self.kill_after(self.lines_until("mosaic")))
        (copy / "odometry.tum").unlink()
        shutil.copy(copy / "images" / "000003.jpg", copy / "images" / "000004.jpg")
        report, _ = self.build("--resume")
        self.assertEqual(report["resumed_frames"], FRAMES - 1)
        fresh = json.loads(run_ok("build", "--survey", copy, "--out", self.folder / "fresh.floormap", "--json"))
        self.assertEqual(report["content_version"], fresh["content_version"])
        self.assertNotEqual(report["content_version"], self.version)

    def test_a_damaged_journal_is_a_warning(self):
        self.assertTrue(self.kill_after(self.lines_until("mosaic")))
        content = bytearray(self.journal.read_bytes())
        for place in range(40, len(content), 997):
            content[place] ^= 255
        self.journal.write_bytes(content)
        report, errors = self.build("--resume")
        self.assertIn("warning: ", errors)
        self.assertIn("damaged", errors)
        self.assertEqual(report["content_version"], self.version)
        self.journal.write_text("not a journal")
        report, errors = self.build("--resume")
        self.assertIn("not a journal", errors)
        self.assertEqual(report["content_version"], self.version)

    def test_nothing_to_resume_is_a_build(self):
        report, _ = self.build("--resume")
        self.assertEqual(report["resumed_frames"], 0)
        self.assertEqual(report["content_version"], self.version)


if __name__ == "__main__":
    unittest.main(verbosity=2)
