#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What operators get in server/ops: configurations, the systemd unit. Usage: ops_test.py FLOORLOC_SERVER"""

import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).parents[3]
OPS = ROOT / "server/ops"
SERVER = sys.argv.pop() if len(sys.argv) > 1 else "floorloc-server"

sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "tests/docs"))
import pages  # noqa: E402


def keys_of(value, prefix=""):
    """The keys of nested objects, as docs/server.md names them, with their values."""
    return {key: item for name, inner in value.items()
            for key, item in (keys_of(inner, f"{prefix}{name}.") if isinstance(inner, dict) else
                              {prefix + name: inner}).items()}


def run(*command):
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)


class ConfigurationTest(unittest.TestCase):
    def check(self, text):
        """What the server says of a configuration."""
        with tempfile.TemporaryDirectory() as folder:
            config = pathlib.Path(folder) / "server.json"
            config.write_text(text, encoding="utf-8")
            token = pathlib.Path(folder) / "token"
            token.write_text("0123456789abcdef", encoding="utf-8")
            token.chmod(0o600)
            return run(SERVER, "--maps", folder, "--listen", "127.0.0.1:0", "--config", str(config), "--check").stdout

    def test_the_example_has_every_key_with_its_default(self):
        text = (OPS / "server.example.json").read_text(encoding="utf-8")
        example = keys_of(json.loads(text))
        self.assertEqual(set(example), pages.Tree(ROOT).config_keys)
        for row in re.findall(r"^\| `([\w.]+)` \| ([^|]+) \|", (ROOT / "docs/server.md").read_text(encoding="utf-8"), re.M):
            if row[0] in example and row[1] != "none":
                value = row[1].strip("`").replace(",", "")
                self.assertEqual(example[row[0]], json.loads(value) if re.match(r"[\d]|true|false", value) else value, row)

    def test_the_server_accepts_the_example_and_the_service_s_own(self):
        for name in ("server.example.json", "server.json"):
            text = (OPS / name).read_text(encoding="utf-8")
            self.assertRegex(self.check(text), r"ok      configuration: ", name)
            self.assertNotRegex(self.check(text), r"FAILED  (?!maps)", name)
        self.assertIn("FAILED  configuration: ", self.check(text.replace("drain_s", "drain")))


class UnitTest(unittest.TestCase):
    def setUp(self):
        if not shutil.which("systemd-analyze"):
            self.skipTest("systemd-analyze is not installed: the unit is not checked")
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        text = (OPS / "floorloc-server.service").read_text(encoding="utf-8")
        self.assertEqual(text.count("/usr/bin/floorloc-server "), 1)
        self.unit = pathlib.Path(folder.name) / "floorloc-server.service"
        text = text.replace("/usr/bin/floorloc-server ", str(pathlib.Path(SERVER).resolve()) + " ")
        # Its pages are not installed here.
        self.unit.write_text(re.sub(r"^Documentation=.*\n", "", text, flags=re.M), encoding="utf-8")

    def test_systemd_understands_it(self):
        result = run("systemd-analyze", "verify", "--man=no", str(self.unit))
        self.assertEqual((result.returncode, result.stderr + result.stdout), (0, ""))

    def test_little_is_exposed(self):
        result = run("systemd-analyze", "security", "--offline=yes", "--threshold=20", str(self.unit))
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)


class MaintainerScriptsTest(unittest.TestCase):
    def test_the_shell_can_read_them(self):
        for name in ("postinst", "prerm", "postrm"):
            result = run("sh", "-n", str(OPS / "debian" / name))
            self.assertEqual((result.returncode, result.stderr), (0, ""), name)
            self.assertTrue((OPS / "debian" / name).stat().st_mode & 0o100, name)


if __name__ == "__main__":
    unittest.main()
