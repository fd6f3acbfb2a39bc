#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What operators get in server/ops: configurations, the systemd unit, alerts, the dashboard.
Usage: ops_test.py FLOORLOC_SERVER FLOORLOC_BRIDGE"""

import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import urllib.request

ROOT = pathlib.Path(__file__).parents[3]
OPS = ROOT / "server/ops"
SERVER, BRIDGE = sys.argv[1:3] if len(sys.argv) > 2 else ("floorloc-server", "floorloc-bridge")
del sys.argv[1:3]

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

    def test_the_bridge_accepts_its_example_whose_keys_are_documented(self):
        example = OPS / "bridge.example.json"
        result = run(BRIDGE, "mqtt", "--config", str(example), "--check")
        self.assertIn("ok      configuration: 1 vehicles", result.stdout, result.stderr)
        page = (ROOT / "docs/vda5050.md").read_text(encoding="utf-8")
        for key in keys_of(json.loads(example.read_text(encoding="utf-8"))):
            self.assertIn(f"`{key}`", page)


class UnitTest(unittest.TestCase):
    def setUp(self):
        if not shutil.which("systemd-analyze"):
            self.skipTest("systemd-analyze is not installed: the unit is not checked")
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.units = []
        for name, program in (("floorloc-server", SERVER), ("floorloc-bridge", BRIDGE)):
            text = (OPS / f"{name}.service").read_text(encoding="utf-8")
            self.assertEqual(text.count(f"/usr/bin/{name} "), 1)
            self.units.append(pathlib.Path(folder.name) / f"{name}.service")
            text = text.replace(f"/usr/bin/{name} ", str(pathlib.Path(program).resolve()) + " ")
            # Its pages are not installed here.
            self.units[-1].write_text(re.sub(r"^Documentation=.*\n", "", text, flags=re.M), encoding="utf-8")

    def test_systemd_understands_them(self):
        result = run("systemd-analyze", "verify", "--man=no", *map(str, self.units))
        self.assertEqual((result.returncode, result.stderr + result.stdout), (0, ""))

    def test_little_is_exposed(self):
        for unit in self.units:
            result = run("systemd-analyze", "security", "--offline=yes", "--threshold=20", str(unit))
            self.assertEqual(result.returncode, 0, result.stdout + result.stderr)


METRIC = re.compile(r"\b(?:floorloc|process)_[a-z_]+\b(?![\"(])")


def metrics_in(text):
    """Metrics that an expression names, without the suffixes of histograms."""
    return {re.sub(r"_(bucket|sum|count)$", "", name) for name in METRIC.findall(text)}


def dashboard_expressions():
    dashboard = json.loads((OPS / "grafana-dashboard.json").read_text(encoding="utf-8"))
    return [target["expr"] for panel in dashboard["panels"] for target in panel["targets"]]


class MetricsTest(unittest.TestCase):
    """Names that the rules, the dashboard and docs/server.md use against what a server answers."""

    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as maps:
            server = subprocess.Popen([SERVER, "--maps", maps, "--listen", "127.0.0.1:0"], text=True,
                                      stderr=subprocess.PIPE)
            try:
                address = next(filter(None, (re.search(r"http://\S+/", line) for line in server.stderr))).group()
                with urllib.request.urlopen(address + "metrics", timeout=10) as page:
                    cls.page = page.read().decode()
            finally:
                server.kill()
                server.wait()
                server.stderr.close()
        # Of vehicles, of which this server has none.
        cls.served = set(re.findall(r"^# TYPE (\S+)", cls.page, re.M)) | {"floorloc_vehicle_silent_seconds"}

    def test_the_page_documents_exactly_what_is_served(self):
        table = re.findall(r"^\| (`(?:floorloc|process)_.*?) \|", (ROOT / "docs/server.md").read_text(encoding="utf-8"), re.M)
        self.assertEqual({name for cell in table for name in METRIC.findall(cell)}, self.served)

    def test_alerts_and_dashboard_use_what_is_served(self):
        rules = re.findall(r"expr: (?:>\n)?((?:.|\n)*?)\n +(?:for|labels):", (OPS / "alerts.yml").read_text(encoding="utf-8"))
        self.assertGreater(len(rules), 10)
        for expression in rules + dashboard_expressions():
            self.assertLessEqual(metrics_in(expression), self.served, expression)


@unittest.skipUnless(shutil.which("promtool"),
                     "promtool (Debian package prometheus) is not installed: rules and expressions are not checked by it")
class PrometheusTest(unittest.TestCase):
    def test_it_understands_the_alerts_and_they_fire(self):
        result = run("promtool", "check", "rules", str(OPS / "alerts.yml"))
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        with tempfile.TemporaryDirectory() as folder:
            shutil.copy(OPS / "alerts.yml", folder)
            shutil.copy(ROOT / "tests/server/ops/alerts_test.yml", folder)
            result = run("promtool", "test", "rules", str(pathlib.Path(folder) / "alerts_test.yml"))
            self.assertEqual(result.returncode, 0, result.stdout + result.stderr)

    def test_it_understands_the_dashboard(self):
        rules = [{"record": f"x:{number}", "expr": text.replace("$__rate_interval", "5m")}
                 for number, text in enumerate(dashboard_expressions())]
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "rules.yml"
            file.write_text(json.dumps({"groups": [{"name": "dashboard", "rules": rules}]}), encoding="utf-8")
            result = run("promtool", "check", "rules", str(file))
            self.assertEqual(result.returncode, 0, result.stdout + result.stderr)


class MaintainerScriptsTest(unittest.TestCase):
    def test_the_shell_can_read_them(self):
        for name in ("postinst", "prerm", "postrm"):
            result = run("sh", "-n", str(OPS / "debian" / name))
            self.assertEqual((result.returncode, result.stderr), (0, ""), name)
            self.assertTrue((OPS / "debian" / name).stat().st_mode & 0o100, name)


if __name__ == "__main__":
    unittest.main()
