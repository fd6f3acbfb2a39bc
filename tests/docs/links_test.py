#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the pages against the tree, and tests the checks themselves. Usage: links_test.py"""

import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
import check_docs  # noqa: E402
import pages  # noqa: E402

ROOT = pathlib.Path(__file__).parents[2]

RUN = """#!/usr/bin/env bash
cat << 'END'
Usage: ./run SUBCOMMAND

  test [--all]   all tests
  bench [DIR]    speed
  bench index    the search
END
"""
COMMAND = """
void AddBuildCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("build", "Builds");
  command->add_option("--out", a->out, "Map");
  command->add_flag("!--no-light", a->light, "Leave it out");
}
"""
CONFIG = """
void ReadWhole(JsonObject& object, const std::string& key, int& value) {
  value = object.Integer(key);
}
void ReadLimits(JsonObject object, Limits& limits) {
  ReadWhole(object, "max_bytes", limits.max_bytes);
}
void ReadLevel(JsonObject& object, std::string& level) {
  level = object.Text("level");
}
ServerConfig ParseServerConfig(const std::string& text) {
  ReadWhole(object, "threads", config.threads);
  ReadLevel(object, config.level);
  if (object.Has("limits")) {
    ReadLimits(object.Object("limits"), config.limits);
  }
  return config;
}
"""
OPENAPI = "paths:\n  /v1/maps:\n    get:\n    post:\ncomponents:\n  x:\n"
SERVER_PAGE = """# Server
## Calls
| call | |
|---|---|
| `GET /v1/maps` | a |
| `POST /v1/maps` | b |
## Configuration
| key | |
|---|---|
| `threads` | a |
| `level` | b |
| `limits.max_bytes` | c |
"""
TREE = {
    "run": RUN,
    "mapbuilder/cli/build_command.cpp": COMMAND,
    "server/config/config_json.cpp": CONFIG,
    "server/daemon/main.cpp": 'app.add_option("--maps", options.maps, "Folder");',
    "server/bridge/main.cpp": "",
    "schema/openapi.yaml": OPENAPI,
    "core/io/survey.cpp": "Survey ReadSurvey() {}\n",
    "docs/server.md": SERVER_PAGE,
    "docs/architecture.md": "```\ncore/\n  io/ what people bring\n```\n",
    "README.md": "# Title\n`floorloc-mapbuilder build --out M --no-light`, `floorloc-server --maps DIR`\n",
}


class TheTreeTest(unittest.TestCase):
    """One case per check, on the real pages."""

    def test_everything_that_the_pages_mention_is_there(self):
        tree = pages.Tree(ROOT)
        for check in check_docs.CHECKS:
            with self.subTest(check.__name__):
                if problems := check(tree):
                    self.fail("\n" + "\n".join(map(str, problems)))

    def test_the_start_page_stays_short(self):
        self.assertLessEqual(len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()), 150)


class CheckDocsTest(unittest.TestCase):
    """The checks on synthetic trees."""

    def problems(self, readme="", **files):
        """Problems of a valid tree after adding these lines to its README and replacing files."""
        tree = dict(TREE, **files)
        tree["README.md"] += readme
        with tempfile.TemporaryDirectory() as folder:
            for path, text in tree.items():
                file = pathlib.Path(folder, path)
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(text)
            checked = pages.Tree(folder)
            return [problem.what for check in check_docs.CHECKS for problem in check(checked)]

    def assert_wrong(self, readme, word):
        problems = self.problems(readme)
        self.assertEqual(len(problems), 1, problems)
        self.assertIn(word, problems[0])

    def test_a_good_tree_has_no_problems(self):
        self.assertEqual(self.problems(), [])

    def test_links_lead_somewhere(self):
        self.assertEqual(self.problems("[a](docs/server.md#calls) [b](#title) [c](https://x.org/a#b) `[d](e)`\n"), [])
        self.assert_wrong("[a](docs/none.md)\n", "docs/none.md")
        self.assert_wrong("![a](none.png)\n", "none.png")
        self.assert_wrong("[a](docs/server.md#keys)\n", "#keys")
        self.assert_wrong("[a](#none)\n", "#none")

    def test_anchors_are_those_of_github(self):
        self.assertEqual(self.problems("## A `b`: [c](#title), d?\n## Twice\n## Twice\n"
                                       "[x](#a-b-c-d) [y](#twice-1)\n"), [])

    def test_paths_exist(self):
        self.assertEqual(self.problems("`core/io/survey.cpp`, `core/io/`, `core/*/survey.cpp`, `core/{io,io}`,\n"
                                       "`core/io/NAME.cpp`, `http/none.h`, `build/none`\n```\nls core/io\n```\n"), [])
        self.assert_wrong("`core/survey.cpp`\n", "there is core/io/survey.cpp")
        self.assert_wrong("`core/{io,map}`\n", "core/{io,map}")
        self.assert_wrong("```\ncat core/none/*.h\n```\n", "core/none/*.h")

    def test_names_exist(self):
        self.assertEqual(self.problems("`ReadSurvey`, `Survey`, `core`, `HTTP`\n"), [])
        self.assert_wrong("`ReadMap`\n", "ReadMap")
        self.assert_wrong("`Survey::Rotate`\n", "Rotate")

    def test_commands_of_run_exist(self):
        self.assertEqual(self.problems("`./run test --all`, `./run bench index`, `./run bench DIR`\n"), [])
        self.assert_wrong("`./run deploy`\n", "deploy")
        self.assert_wrong("```sh\n./run bench none   # x\n```\n", "bench none")

    def test_subcommands_and_options_exist(self):
        self.assert_wrong("```\nfloorloc-mapbuilder destroy\n```\n", "destroy")
        self.assert_wrong("```\nfloorloc-mapbuilder build \\\n    --in x   # --comment\n```\n", "--in")
        self.assert_wrong("`floorloc-server --port 1`\n", "--port")

    def test_subcommands_and_options_are_documented(self):
        more = COMMAND + 'command->add_option("--light", a->light, "Of it");'
        self.assertEqual(self.problems(**{"mapbuilder/cli/build_command.cpp": more}),
                         ["the option --light of 'build' is not documented"])
        other = 'app.add_subcommand("info", "Says")'
        self.assertEqual(self.problems(**{"mapbuilder/cli/info_command.cpp": other}),
                         ["the subcommand 'info' is not documented"])

    def test_configuration_keys_are_documented_and_exist(self):
        self.assertEqual(self.problems(**{"docs/server.md": SERVER_PAGE.replace("limits.max_bytes", "limits.bytes")}),
                         ["the configuration key limits.bytes does not exist",
                          "the configuration key limits.max_bytes is not documented"])
        self.assertEqual(self.problems(**{"docs/server.md": SERVER_PAGE.replace("| `level` | b |\n", "")}),
                         ["the configuration key level is not documented"])

    def test_calls_are_documented_and_exist(self):
        self.assertEqual(self.problems(**{"docs/server.md": SERVER_PAGE.replace("POST", "PUT")}),
                         ["the call PUT /v1/maps does not exist", "the call POST /v1/maps is not documented"])

    def test_functions_stand_in_the_files_of_their_row(self):
        row = "| reads | `ReadSurvey` | `core/io/survey.cpp` |\n"
        self.assertEqual(self.problems(row), [])
        elsewhere = {"core/io/video.cpp": "void ReadVideo();\n"}
        self.assertEqual(self.problems(row + row.replace("Survey", "Video"), **elsewhere),
                         ["ReadVideo is in none of the files of its row"])

    def test_messages_are_those_of_the_programs(self):
        page = "| message | cause |\n|---|---|\n| `is …m wide; add \"m\"`, `too long` | `none` |\n"
        source = 'Fail("is " + Text(n) + "m wide; "\n     "add \\"m\\"");\nFail("too long");\n'
        files = {"docs/troubleshooting.md": page, "core/io/width.cpp": source}
        self.assertEqual(self.problems(**files), [])
        files["docs/troubleshooting.md"] = page.replace("wide", "broad").replace("too", "very")
        self.assertEqual(self.problems(**files), ["no program says 'm broad; add \"m\"'", "no program says 'very long'"])

    def test_the_layout_has_every_folder(self):
        self.assertEqual(self.problems(**{"core/map/map.h": "", "core/io/survey.h": ""}),
                         ["core/map/ is missing in the layout"])


if __name__ == "__main__":
    unittest.main()
