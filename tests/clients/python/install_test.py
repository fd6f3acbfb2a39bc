#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""pip installs the Python client from its folder, without network."""

import importlib.util
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

CLIENT = pathlib.Path(__file__).parents[3] / "clients/python"
USE = "import floorloc, floorloc.ros, floorloc.types, pathlib; print(pathlib.Path(floorloc.__file__).parent)"


@unittest.skipUnless(importlib.util.find_spec("pip"), "pip is not installed")
class InstallTest(unittest.TestCase):
    def install(self):
        site = self.enterContext(tempfile.TemporaryDirectory(prefix="floorloc-pip-"))
        source = pathlib.Path(site) / "source"
        shutil.copytree(CLIENT, source, ignore=shutil.ignore_patterns("__pycache__"))
        subprocess.run([sys.executable, "-m", "pip", "install", "--quiet", "--no-index", "--disable-pip-version-check",
                        "--target", f"{site}/site", source], check=True, timeout=100,
                       stderr=subprocess.PIPE)
        return pathlib.Path(site)

    def test_the_package_is_whole(self):
        site = self.install() / "site"
        used = subprocess.run([sys.executable, "-c", USE], check=True, cwd="/", env={"PYTHONPATH": str(site)},
                              capture_output=True, text=True).stdout.strip()
        self.assertEqual(used, str(site / "floorloc"))
        have, want = ({file.relative_to(folder).as_posix() for file in folder.glob("floorloc/**/*")
                       if file.suffix in (".py", ".typed")} for folder in (site, CLIENT))
        self.assertEqual(have, want)
        metadata = next(site.glob("floorloc-*.dist-info/METADATA")).read_text(encoding="utf-8")
        self.assertIn("Requires-Python: >=3.8", metadata)


if __name__ == "__main__":
    unittest.main()
