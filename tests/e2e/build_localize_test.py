# SPDX-License-Identifier: Apache-2.0
"""The main workflow with the real floorloc-mapbuilder: simulate, build, inspect, localize, evaluate. Every failure must
give one sentence, exit code 1 and no partial output."""

import hashlib
import json
import math
import random
import re
import resource
import shutil
import signal
import struct
import subprocess
import time
import unittest
from pathlib import Path

from builder import BINARY, Scratch, run, run_ok, run_unusable

FRAME_KEYS = {
    "timestamp", "filename", "status", "x", "y", "yaw", "covariance", "inliers", "p_wrong", "timing_ms",
}
MORE_FRAME_KEYS = {"alternatives", "keypoints", "matches", "rms_m", "search", "support_area"}


def digest(file):
    return hashlib.sha256(Path(file).read_bytes()).hexdigest()


def read_tum(file):
    rows = [line.split() for line in Path(file).read_text().splitlines() if line and not line.startswith("#")]
    return {row[0]: [float(value) for value in row[1:]] for row in rows}


class Recorded(Scratch):
    """Makes once: a survey, a drive over the same floor, and the survey's map in the floor's frame."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.survey = cls.root / "survey"
        cls.drive = cls.root / "drive"
        cls.map = cls.root / "hall.floormap"
        floor = ["simulate", "--texture", "concrete", "--size", "1.2x0.9", "--floor-seed", "5"]
        run_ok(*floor, "--out", cls.survey, "--seed", "1")
        run_ok(*floor, "--out", cls.drive, "--seed", "2", "--trajectory", "drive", "--frames", "20", "--fps", "4")
        run_ok("build", "--survey", cls.survey, "--out", cls.map, "--poses", cls.survey / "groundtruth.tum",
               "--poses-sigma", "0.005,0.005")

    def copy_of_survey(self):
        copy = self.folder / "survey"
        shutil.copytree(self.survey, copy)
        return copy


class MainJob(Recorded):
    def test_info_says_what_the_map_holds(self):
        info = json.loads(run_ok("info", self.map, "--json"))
        self.assertEqual(info["name"], "hall")
        self.assertEqual(info["frame"], "map")
        self.assertEqual(info["frames"], 28)
        self.assertEqual(info["extractor"]["type"], "hessian")
        self.assertGreater(info["keypoints"], 2000)
        self.assertAlmostEqual(info["area_m2"], 1.08, delta=0.1)
        self.assertRegex(info["version"], "^[0-9a-f]{64}$")
        self.assertEqual(info["surveys"][0]["frames"], 28)
        self.assertEqual(info["report"]["frames_used"], 28)
        self.assertIn(info["version"], run_ok("info", self.map))

    def test_verify_finds_the_map_whole(self):
        self.assertIn("whole", run_ok("verify", self.map))

    def test_build_reports_in_json(self):
        report = json.loads(run_ok("build", "--survey", self.survey, "--out", self.folder / "m.floormap", "--json"))
        self.assertEqual(report["frames"], 28)
        self.assertEqual(report["parts"], [28])
        self.assertEqual(set(report["stage_s"]), {"features", "poses", "keypoints", "held-out", "mosaic", "write"})
        again = json.loads(run_ok("build", "--survey", self.survey, "--out", self.folder / "m.floormap", "--json",
                                  "--threads", "1"))
        self.assertEqual(again["content_version"], report["content_version"])

    def test_build_says_whether_the_map_can_be_trusted(self):
        arguments = ["build", "--survey", self.survey, "--out", self.folder / "m.floormap"]
        self.assertRegex(run_ok(*arguments), r"verdict      You can trust this map")
        result = run(*arguments, "--json")
        self.assertRegex(result.stderr, r"m\.floormap: You can trust this map")
        self.assertRegex(json.loads(result.stdout)["verdict"]["headline"], "You can trust this map")

    def test_export_writes_mosaic_world_file_and_poses(self):
        mosaic = self.folder / "mosaic.png"
        run_ok("export", self.map, "--mosaic", mosaic, "--resolution", "0.0014", "--worldfile", "--poses",
               self.folder / "poses.tum")
        width, height = struct.unpack(">II", mosaic.read_bytes()[16:24])
        a, d, b, e, c, f = [float(line) for line in (self.folder / "mosaic.pgw").read_text().split()]
        self.assertAlmostEqual(a, 0.0014, delta=1e-5)
        self.assertEqual((d, b, e), (0.0, 0.0, -a))
        extent = json.loads(run_ok("info", self.map, "--json"))["extent"]
        self.assertLessEqual(c - a / 2, extent["x_min"] + 1e-6)
        self.assertGreaterEqual(c - a / 2 + width * a, extent["x_max"] - 1e-6)
        self.assertGreaterEqual(f + a / 2, extent["y_max"] - 1e-6)
        self.assertLessEqual(f + a / 2 - height * a, extent["y_min"] + 1e-6)
        truth = read_tum(self.survey / "groundtruth.tum")
        poses = read_tum(self.folder / "poses.tum")
        self.assertEqual(set(poses), set(truth))
        for stamp, pose in poses.items():
            self.assertLess(math.dist(pose[:2], truth[stamp][:2]), 2e-3, stamp)

    def test_export_writes_the_formats_of_other_tools(self):
        out = self.folder
        run_ok("export", self.map, "--geotiff", out / "map.tif", "--tiles", out / "tiles", "--nav2", out / "map.yaml",
               "--g2o", out / "map.g2o")
        info = json.loads(run_ok("info", self.map, "--json"))
        self.assertEqual((out / "map.tif").read_bytes()[:4], b"II*\0")
        tiles = json.loads((out / "tiles" / "metadata.json").read_text())
        self.assertEqual(tiles["version"], info["version"])
        for level in tiles["levels"]:
            images = list((out / "tiles" / str(level["z"])).glob("*/*.jpg"))
            self.assertTrue(images)
            for image in images:
                self.assertEqual(image.read_bytes()[:2], b"\xff\xd8")
                self.assertLess(int(image.parent.name) * level["tile_m"], tiles["extent"][2])
                self.assertGreater((int(image.stem) + 1) * level["tile_m"], tiles["extent"][1])
        magic, size, depth, cells = (out / "map.pgm").read_bytes().split(b"\n", 3)
        width, height = map(int, size.split())
        self.assertEqual((magic, depth, len(cells)), (b"P5", b"255", width * height))
        self.assertAlmostEqual(cells.count(254) * 0.05 ** 2, info["area_m2"], delta=0.15)
        lines = [line.split() for line in (out / "map.g2o").read_text().splitlines()]
        vertices = {int(line[1]): [float(v) for v in line[2:]] for line in lines if line[0] == "VERTEX_SE2"}
        edges = [line for line in lines if line[0] == "EDGE_SE2"]
        self.assertEqual(len(vertices), 28)
        self.assertGreater(len(edges), 40)
        for edge in edges:
            x1, y1, yaw = vertices[int(edge[1])]
            x2, y2, _ = vertices[int(edge[2])]
            x, y = float(edge[3]), float(edge[4])
            seen = (x1 + math.cos(yaw) * x - math.sin(yaw) * y, y1 + math.sin(yaw) * x + math.cos(yaw) * y)
            self.assertLess(math.dist(seen, (x2, y2)), 5e-3)
        # A second export replaces files, not folders.
        run_ok("export", self.map, "--nav2", out / "map.yaml", "--resolution", "0.1")
        self.assertIn("resolution: 0.1\n", (out / "map.yaml").read_text())
        refused = run("export", self.map, "--tiles", out / "tiles")
        self.assertEqual(refused.returncode, 1)
        self.assertIn("not an empty folder", refused.stderr)

    def localize(self, prior):
        out = self.folder / "estimate.tum"
        results = self.folder / "results.jsonl"
        run_ok("localize", "--map", self.map, "--frames", self.drive, "--out", out, "--results", results, "--prior",
               prior)
        lines = [json.loads(line) for line in results.read_text().splitlines()]
        self.assertEqual(len(lines), 20)
        return out, lines

    def check_localized(self, prior):
        out, lines = self.localize(prior)
        truth = read_tum(self.drive / "groundtruth.tum")
        by_stamp = {round(float(stamp), 5): pose for stamp, pose in truth.items()}
        for line in lines:
            self.assertEqual(set(line), FRAME_KEYS | MORE_FRAME_KEYS)
            self.assertEqual(line["status"], "localized", line)
            self.assertEqual(len(line["covariance"]), 9)
            self.assertTrue(all(math.isfinite(value) for value in line["covariance"]))
            self.assertGreater(line["timing_ms"]["total"], 0)
            pose = by_stamp[round(line["timestamp"], 5)]
            yaw = 2 * math.atan2(pose[5], pose[6])
            self.assertLess(math.dist((line["x"], line["y"]), pose[:2]), 2e-3, line)
            self.assertLess(abs(math.remainder(line["yaw"] - yaw, 2 * math.pi)), math.radians(0.2), line)
        for metric in ("ape", "rpe"):
            errors = json.loads(run_ok("evaluate", metric, self.drive / "groundtruth.tum", out, "--json"))
            self.assertEqual(errors["pairs"], 20)
            self.assertLess(errors["translation"]["rmse"], 2e-3)
        return lines

    def test_localizes_on_the_whole_map(self):
        self.assertEqual({line["search"] for line in self.check_localized("none")}, {"global"})

    def test_localizes_with_the_truth_as_prior(self):
        self.assertEqual({line["search"] for line in self.check_localized("truth")}, {"prior"})

    def test_localizes_along_odometry(self):
        lines = self.check_localized("odometry")
        self.assertEqual(lines[0]["search"], "global")
        self.assertEqual({line["search"] for line in lines[1:]}, {"prior"})

    def test_a_camera_with_another_resolution_is_localized(self):
        frames = self.folder / "coarse"
        shutil.copytree(self.drive, frames)
        floor = frames / "floor.yaml"
        floor.write_text(re.sub(r"resolution: \S+", "resolution: 0.0011", floor.read_text()))
        out = self.folder / "coarse.tum"
        run_ok("localize", "--map", self.map, "--frames", frames, "--out", out)
        self.assertEqual(len(read_tum(out)), len(list((frames / "images").iterdir())))

    def test_a_frame_of_another_floor_is_not_localized(self):
        other = self.folder / "other"
        run_ok("simulate", "--texture", "carpet", "--size", "1.2x0.9", "--out", other, "--trajectory", "random",
               "--frames", "5")
        results = self.folder / "results.jsonl"
        run_ok("localize", "--map", self.map, "--frames", other, "--out", self.folder / "e.tum", "--results", results)
        for line in map(json.loads, results.read_text().splitlines()):
            self.assertEqual(line["status"], "not_localized")
            self.assertEqual(set(line), FRAME_KEYS | MORE_FRAME_KEYS | {"reason"})
            self.assertIsNone(line["x"])
            self.assertTrue(line["reason"])

    def test_the_acceptance_threshold_is_the_probability_of_being_wrong(self):
        results = self.folder / "strict.jsonl"
        run_ok("localize", "--map", self.map, "--frames", self.drive, "--out", self.folder / "e.tum", "--results",
               results, "--max-p-wrong", "1e-12")
        for line in map(json.loads, results.read_text().splitlines()):
            self.assertNotEqual(line["status"], "localized")
            self.assertGreater(line["p_wrong"], 1e-12)

    def test_the_answers_do_not_depend_on_threads(self):
        def answers(threads):
            results = self.folder / f"{threads}.jsonl"
            run_ok("localize", "--map", self.map, "--frames", self.drive, "--out", self.folder / "e.tum", "--results",
                   results, "--threads", threads)
            lines = [json.loads(line) for line in results.read_text().splitlines()]
            return [{key: value for key, value in line.items() if key != "timing_ms"} for line in lines]

        self.assertEqual(answers(1), answers(4))


class CorrectedCamera(Scratch):
    """A survey and a drive with one camera, whose floor.yaml is wrong by half a degree."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.drive = cls.root / "drive"
        cls.map = cls.root / "hall.floormap"
        floor = ["simulate", "--texture", "concrete", "--size", "1.2x0.9", "--floor-seed", "5", "--pitch-error", "0.5"]
        run_ok(*floor, "--out", cls.root / "survey", "--seed", "1")
        run_ok(*floor, "--out", cls.drive, "--seed", "2", "--trajectory", "drive", "--frames", "12", "--fps", "4")
        run_ok("build", "--survey", cls.root / "survey", "--out", cls.map, "--no-held-out")

    def localize(self, *options):
        out = self.folder / "estimate.tum"
        return run_ok("localize", "--map", self.map, "--frames", self.drive, "--out", out, *options), read_tum(out)

    def test_localize_says_that_the_map_corrected_the_camera(self):
        sentence = r"camera corrected as survey 1 of 1 of the map corrected it: floor points move by up to \d+\.\d px\n"
        declined, given = self.localize("--no-camera-correction")
        self.assertNotIn("corrected", declined)
        for options in [[], ["--fuse"]]:
            said, corrected = self.localize(*options)
            self.assertRegex(said, sentence)
            self.assertNotEqual(corrected, given)
        fused, _ = self.localize("--fuse", "--no-camera-correction")
        self.assertNotIn("corrected", fused)


class Usage(unittest.TestCase):
    def test_help_and_version_succeed(self):
        for arguments in (["--help"], ["--version"], ["build", "--help"], ["localize", "--help"]):
            self.assertEqual(run(*arguments).returncode, 0, arguments)

    def test_wrong_usage_is_2(self):
        wrong = [
            [], ["fly"], ["build"], ["build", "--survey", "x"], ["info"], ["localize", "--map", "m"],
            ["build", "--survey", "x", "--out", "y", "--colour", "red"],
            ["build", "--survey", "x", "--out", "y", "--threads", "many"],
            ["build", "--survey", "x", "--out", "y", "--features", "surff"],
            ["build", "--survey", "x", "--out", "y", "--poses-sigma", "0.1,0.1"],
            ["localize", "--map", "m", "--frames", "f", "--out", "o", "--prior", "guess"],
            ["localize", "--map", "m", "--frames", "f", "--out", "o", "--matcher", "lsh"],
            ["evaluate", "speed", "a", "b"],
        ]
        for arguments in wrong:
            result = run(*arguments)
            self.assertEqual(result.returncode, 2, arguments)
            self.assertTrue(result.stderr.strip(), arguments)


class BadInput(Recorded):
    def expect_failure(self, named, *arguments, **options):
        """Expects exit code 1 and one sentence that names the file, after any progress and warnings."""
        result = run(*arguments, **options)
        self.assertEqual(result.returncode, 1, result.stderr)
        sentences = [line for line in result.stderr.splitlines()
                     if not re.match(r"\w+: \d+ % ", line) and not line.startswith("warning: ")]
        self.assertEqual(len(sentences), 1, result.stderr)
        self.assertTrue(sentences[0].startswith("floorloc-mapbuilder: "), sentences[0])
        self.assertIn(str(named), sentences[0])
        return sentences[0]

    def expect_build_failure(self, named, survey, **options):
        out = self.folder / "out" / "m.floormap"
        out.parent.mkdir(exist_ok=True)
        sentence = self.expect_failure(named, "build", "--survey", survey, "--out", out, **options)
        left = {file.name for file in out.parent.iterdir()}
        self.assertLessEqual(left, {"m.floormap.journal"}, sentence)  # the journal is kept after two seconds of work
        self.assertEqual("m.floormap.journal" in left, "--resume" in sentence)
        return sentence

    def test_files_that_are_missing(self):
        for name in ("camera.yaml", "floor.yaml"):
            with self.subTest(name):
                survey = self.copy_of_survey()
                (survey / name).unlink()
                self.expect_build_failure(Path(name).name, survey)
                shutil.rmtree(survey)

    def test_files_that_are_malformed(self):
        broken = {
            "camera.yaml": "image_width: [640\n",
            "floor.yaml": "homography: [1, 2, 3]\n",
            "frames.csv": "timestamp,filename\n12:30,images/000000.jpg\n",
            "odometry.tum": "1 2 3\n",
            "groundtruth.tum": "1 0 0 0 0 0 0 nan\n",
            "control_points.csv": "filename,u,v,x,y\nimages/nowhere.jpg,1,2,3,4\n",
            "imu.csv": "1,2\n",
        }
        for name, text in broken.items():
            with self.subTest(name):
                survey = self.copy_of_survey()
                (survey / name).write_text(text)
                self.expect_build_failure(Path(name).name, survey)
                shutil.rmtree(survey)

    def test_image_of_another_size(self):
        survey = self.copy_of_survey()
        text = (survey / "camera.yaml").read_text()
        (survey / "camera.yaml").write_text(text.replace("640", "800").replace("480", "600"))
        sentence = self.expect_build_failure("images/", survey)
        self.assertIn("640", sentence)

    def test_single_broken_images_are_left_out_and_named(self):
        def cut_off(image):
            image.write_bytes(image.read_bytes()[:5000])

        damages = {
            "missing": lambda image: image.unlink(),
            "no image": lambda image: image.write_text("no image at all"),
            "cut off": cut_off,
        }
        for name, damage in damages.items():
            with self.subTest(name):
                survey = self.copy_of_survey()
                damage(survey / "images" / "000007.jpg")
                report = json.loads(run_ok("build", "--survey", survey, "--out", self.folder / "m.floormap", "--json"))
                self.assertEqual(report["frames_used"], report["frames"] - 1)
                self.assertEqual([row["filename"] for row in report["dropped"]], ["images/000007.jpg"])
                self.assertTrue(report["dropped"][0]["reason"])
                shutil.rmtree(survey)

    def test_many_broken_images_are_refused(self):
        survey = self.copy_of_survey()
        for i in range(5):
            (survey / "images" / f"00000{i}.jpg").write_text("no image at all")
        self.expect_build_failure("images", survey)

    def test_folders_without_a_survey(self):
        empty = self.folder / "empty"
        empty.mkdir()
        self.expect_build_failure("empty", empty)
        self.expect_build_failure("missing", self.folder / "missing")
        self.expect_build_failure("hall.floormap", self.map)  # a file
        no_images = self.copy_of_survey()
        (no_images / "frames.csv").write_text("timestamp,filename\n")
        self.expect_build_failure("frames.csv", no_images)

    def test_places_that_cannot_be_written(self):
        self.expect_failure("m.floormap", "build", "--survey", self.survey, "--out",
                            self.folder / "missing" / "m.floormap")
        nowhere = self.folder / "missing"
        self.expect_failure("e.tum", "localize", "--map", self.map, "--frames", self.drive, "--out", nowhere / "e.tum")
        self.expect_failure("m.png", "export", self.map, "--mosaic", nowhere / "m.png")
        self.expect_failure("m.bmp", "export", self.map, "--mosaic", self.folder / "m.bmp")
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_a_full_disk(self):
        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))

        sentence = self.expect_build_failure("m.floormap", self.survey, preexec_fn=limit)
        self.assertIn("disk", sentence)

    def test_maps_that_are_damaged_or_none(self):
        damaged = self.folder / "damaged.floormap"
        content = bytearray(self.map.read_bytes())
        half = len(content) // 2
        cases = {
            "cut off": bytes(content[:half]),
            "overwritten": bytes(content[:4096]) + bytes(len(content) - 4096),
            "empty": b"",
            "text": b"timestamp,filename\n",
        }
        commands = [
            ["info", damaged],
            ["verify", damaged],
            ["export", damaged, "--mosaic", self.folder / "m.png"],
            ["localize", "--map", damaged, "--frames", self.drive, "--out", self.folder / "e.tum"],
        ]
        for name, case in cases.items():
            damaged.write_bytes(case)
            for command in commands:
                with self.subTest(f"{name} {command[0]}"):
                    self.expect_failure("damaged.floormap", *command)
        damaged.unlink()
        for command in commands:
            self.expect_failure("damaged.floormap", *command)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_verify_finds_a_flipped_bit_in_the_mosaic(self):
        damaged = self.folder / "damaged.floormap"
        content = bytearray(self.map.read_bytes())
        place = content.rindex(b"\xff\xd8\xff") + 700  # inside a JPEG
        content[place] ^= 1
        damaged.write_bytes(content)
        self.expect_failure("damaged.floormap", "verify", damaged)

    def test_two_parts_are_reported(self):
        survey = self.copy_of_survey()
        (survey / "odometry.tum").unlink()
        rows = (survey / "frames.csv").read_text().splitlines()
        # Lanes of seven frames in alternating directions: without the middle two of each, a gap divides the floor.
        kept = [row for i, row in enumerate(rows[1:]) if i % 7 not in ((3, 4) if i // 7 % 2 == 0 else (2, 3))]
        (survey / "frames.csv").write_text("\n".join([rows[0], *kept]) + "\n")
        out = self.folder / "m.floormap"
        report = json.loads(run_unusable("build", "--survey", survey, "--out", out, "--json"))
        self.assertEqual(report["parts"], [12, 8])
        self.assertEqual(report["frames_used"], 12)
        self.assertEqual(report["verdict"]["trust"], "survey_again")
        run_ok("verify", out)
        text = run_unusable("build", "--survey", survey, "--out", out)
        self.assertIn("--keep-all", text)
        self.assertIn("verdict      Do not use this map", text)
        report = json.loads(run_ok("build", "--survey", survey, "--out", out, "--json", "--keep-all"))
        self.assertEqual(report["frames_used"], 20)


def version(floormap):
    return json.loads(run_ok("info", floormap, "--json"))["version"]


class Killed(Recorded):
    def test_no_instant_of_a_build_harms_the_old_map(self):
        out = self.folder / "m.floormap"
        shutil.copy(self.map, out)
        command = [BINARY, "build", "--survey", str(self.survey), "--out", str(out)]
        start = time.monotonic()
        run_ok("build", "--survey", self.survey, "--out", self.folder / "other.floormap")
        duration = time.monotonic() - start
        old, new = version(out), version(self.folder / "other.floormap")
        draw = random.Random(1)
        for _ in range(10):
            build = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            try:
                build.wait(draw.uniform(0.0, duration))
            except subprocess.TimeoutExpired:
                build.kill()
                build.wait()
                run_ok("verify", out)
                self.assertIn(version(out), (old, new))  # the new one is in place before its verdict is known
            old = version(out)
        run_ok(*command[1:])
        run_ok("verify", out)
        self.assertNotEqual(digest(out), digest(self.map))
        self.assertEqual({file.name for file in self.folder.iterdir()}, {"m.floormap", "other.floormap"})

    def test_two_builds_at_once_do_not_mix(self):
        out = self.folder / "m.floormap"
        command = [BINARY, "build", "--survey", str(self.survey), "--out", str(out)]
        builds = [subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
                  for _ in range(2)]
        errors = [build.communicate()[1] for build in builds]
        codes = sorted(build.returncode for build in builds)
        self.assertIn(codes, ([0, 0], [0, 1]), errors)
        if codes == [0, 1]:
            self.assertIn("being written by another", "".join(errors))
        run_ok("verify", out)


if __name__ == "__main__":
    unittest.main(verbosity=2)
