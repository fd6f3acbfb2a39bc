#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of count_cases.py."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).parent / "count_cases.py"

GOOGLE_TEST_REPORT = """<?xml version="1.0" encoding="UTF-8"?>
<testsuites tests="4" failures="{failures}" disabled="1" errors="0" time="0.1" name="AllTests">
  <testsuite name="Camera" tests="4" failures="{failures}" disabled="1" skipped="1" errors="0" time="0.1">
    <testcase name="Projects" status="run" result="completed" time="0.1" classname="Camera">{failure}</testcase>
    <testcase name="Undistorts" status="run" result="completed" time="0.1" classname="Camera" />
    <testcase name="Rests" status="run" result="skipped" time="0.1" classname="Camera"><skipped /></testcase>
    <testcase name="DISABLED_Flies" status="notrun" result="suppressed" time="0" classname="Camera" />
  </testsuite>
</testsuites>"""


def ctest_case(name, status):
    failure = '<failure message="SEGFAULT"/>' if status == "fail" else ""
    return f'<testcase name="{name}" classname="{name}" time="1" status="{status}">{failure}</testcase>'


class CountCasesTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def report(self, name, failure=""):
        text = GOOGLE_TEST_REPORT.format(failures=int(bool(failure)), failure=failure)
        (pathlib.Path(self.folder.name) / f"{name}.xml").write_text(text, encoding="utf-8")

    def count(self, *cases):
        junit = pathlib.Path(self.folder.name) / "ctest-junit"
        junit.write_text(f'<testsuite name="ctest">{"".join(cases)}</testsuite>', encoding="utf-8")
        result = subprocess.run([sys.executable, SCRIPT, junit, self.folder.name], check=True, capture_output=True, text=True)
        return result.stdout.split("\n", 1)

    def test_counts_the_cases_of_binaries_and_tests_without_a_report(self):
        self.report("camera_test.0")
        self.report("camera_test.1")
        numbers, failures = self.count(ctest_case("camera_test.0", "run"), ctest_case("camera_test.1", "run"),
                                       ctest_case("e2e.build", "run"), ctest_case("e2e.unwanted", "notrun"))
        self.assertEqual(numbers, "5 0")
        self.assertEqual(failures.strip(), "")

    def test_names_failed_cases(self):
        self.report("camera_test", failure='<failure message="off by 2 px"></failure>')
        numbers, failures = self.count(ctest_case("camera_test", "fail"), ctest_case("e2e.build", "fail"))
        self.assertEqual(numbers, "1 2")
        self.assertEqual(failures.split("\n")[:2], ["camera_test: Camera.Projects", "e2e.build: SEGFAULT"])

    def test_a_binary_that_crashed_has_failed(self):
        self.assertEqual(self.count(ctest_case("camera_test", "fail"))[0], "0 1")

    def test_a_binary_that_was_not_built_has_failed(self):
        missing = '<testcase name="camera_test" status="notrun"><skipped message="Unable to find executable"/></testcase>'
        numbers, failures = self.count(missing)
        self.assertEqual(numbers, "0 1")
        self.assertEqual(failures.strip(), "camera_test: was not built")

    def test_a_binary_that_failed_after_its_cases_has_failed(self):
        self.report("camera_test")
        self.assertEqual(self.count(ctest_case("camera_test", "fail"))[0], "2 1")


if __name__ == "__main__":
    unittest.main()
