#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The layering check rejects violations and accepts valid trees."""

import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
import check_layers  # noqa: E402


class CheckLayersTest(unittest.TestCase):
    def check(self, files):
        """Output of the check for a tree of these files."""
        with tempfile.TemporaryDirectory() as folder:
            for path, text in files.items():
                file = pathlib.Path(folder, path)
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(text)
            return [str(problem) for problem in check_layers.check_tree(pathlib.Path(folder))]

    def assert_forbidden(self, path, line):
        self.assertEqual(len(self.check({path: f"// first line\n{line}\n"})), 1, f"{path}: {line}")

    def assert_allowed(self, path, line):
        self.assertEqual(self.check({path: line}), [])

    def test_the_table_has_no_cycle(self):
        for layer, below in check_layers.ARROWS.items():
            for target in below:
                self.assertNotIn(layer, check_layers.reachable(target))

    def test_arrows_down_are_allowed(self):
        self.assert_allowed("core/localization/a.cpp", '#include "core/geometry/pose2.h"')
        self.assert_allowed("core/map/a.cpp", '#include "core/map/map_database.h"')
        self.assert_allowed("server/serving/a.cpp", '#include "core/localization/localizer.h"')
        self.assert_allowed("mapbuilder/cli/a.cpp", '#include "mapbuilder/build/build_map.h"')
        self.assert_allowed("server/api/a.cpp", '#include "server/wire/problem.h"')

    def test_arrows_up_and_sideways_are_forbidden(self):
        self.assert_forbidden("core/geometry/a.h", '#include "core/vision/features/features.h"')
        self.assert_forbidden("core/registration/a.cpp", '  #  include "core/vision/features/features.h"')
        self.assert_forbidden("core/map/a.cpp", '#include "mapbuilder/build/build_map.h"')
        self.assert_forbidden("server/api/a.cpp", '#include "mapbuilder/build/build_map.h"')
        self.assert_forbidden("server/http/a.cpp", '#include "server/config/config.h"')
        self.assert_forbidden("mapbuilder/build/a.cpp", '#include "server/api/app.h"')
        self.assert_forbidden("mapbuilder/build/a.cpp", '#include "mapbuilder/cli/command.h"')
        self.assert_forbidden("mapbuilder/screening/a.cpp", '#include "mapbuilder/build/build_report.h"')
        self.assert_forbidden("core/vision/image/a.cpp", '#include "core/vision/features/features.h"')
        self.assert_forbidden("core/io/a.cpp", '#include "tests/synthetic/floor.h"')

    def test_a_path_that_does_not_start_at_the_root_is_forbidden(self):
        self.assert_forbidden("core/io/a.cpp", '#include "survey.h"')
        self.assert_forbidden("core/io/a.cpp", '#include "../map/floor_map.h"')

    def test_libraries_stay_in_their_layers(self):
        self.assert_allowed("server/http/a.cpp", "#include <httplib.h>")
        self.assert_forbidden("server/api/a.cpp", "#include <httplib.h>")
        self.assert_forbidden("core/io/a.cpp", "#include <httplib.h>")
        self.assert_forbidden("mapbuilder/a.cpp", "#include <httplib.h>")
        self.assert_allowed("core/map/a.cpp", "#include <sqlite3.h>")
        self.assert_forbidden("server/a.cpp", "#include <sqlite3.h>")
        self.assert_allowed("mapbuilder/cli/a.cpp", "#include <CLI/CLI.hpp>")
        self.assert_forbidden("mapbuilder/build/a.cpp", "#include <CLI/CLI.hpp>")
        self.assert_allowed("core/map/a.cpp", "#include <nlohmann/json.hpp>")
        self.assert_forbidden("core/vision/a.cpp", "#include <nlohmann/json.hpp>")
        self.assert_forbidden("core/geometry/a.cpp", "#include <opencv2/core/mat.hpp>")

    def test_link_lines_follow_the_same_arrows(self):
        self.assert_allowed("core/map/CMakeLists.txt", "floorloc_library(map PUBLIC floorloc::vision)")
        self.assert_forbidden("core/vision/CMakeLists.txt", "floorloc_library(vision PUBLIC floorloc::map)")

    def test_unknown_and_shapeless_folders_are_forbidden(self):
        self.assert_forbidden("core/helpers/a.h", "")
        self.assert_forbidden("tests/util/a.txt", "")
        self.assertEqual(self.check({"build/util/a.txt": "", "tests/browser/node_modules/util/a.js": ""}), [])

    def test_a_source_includes_its_own_header_first(self):
        own, other = '#include "server/a.h"\n', '#include "server/b.h"\n'
        self.assertEqual(self.check({"server/a.h": "", "server/b.h": "", "server/a.cpp": "// x\n" + own + other}), [])
        problems = self.check({"server/a.h": "", "server/b.h": "", "server/a.cpp": other + own})
        self.assertEqual(problems, ['server/a.cpp:1: must include "server/a.h" first'])

    def test_a_problem_names_file_and_line(self):
        problems = self.check({"server/a.cpp": '// first\n#include "mapbuilder/build.h"\n'})
        self.assertTrue(problems[0].startswith("server/a.cpp:2: server must not include mapbuilder"), problems)


if __name__ == "__main__":
    unittest.main()
