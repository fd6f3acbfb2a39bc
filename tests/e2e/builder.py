# SPDX-License-Identifier: Apache-2.0
"""Runs the real floorloc-mapbuilder, whose path is the test's first argument."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

BINARY = sys.argv.pop(1)


def run(*arguments, timeout=120, **options):
    command = [BINARY, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=timeout, check=False, **options)


def run_ok(*arguments, timeout=120):
    result = run(*arguments, timeout=timeout)
    if result.returncode != 0:
        raise AssertionError(f"{arguments} failed with {result.returncode}: {result.stderr}")
    return result.stdout


def run_unusable(*arguments, timeout=120):
    """A build whose map is written, but not to be used."""
    result = run(*arguments, timeout=timeout)
    if result.returncode != 3 or "do not use it" not in result.stderr:
        raise AssertionError(f"{arguments} ended with {result.returncode}, not 3: {result.stderr}")
    return result.stdout


class Scratch(unittest.TestCase):
    """Provides a folder for the class, `root`, and one for each test case, `folder`."""

    @classmethod
    def setUpClass(cls):
        shared = tempfile.TemporaryDirectory(prefix="floorloc-e2e-")
        cls.addClassCleanup(shared.cleanup)
        cls.root = Path(shared.name)

    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="floorloc-e2e-")
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
