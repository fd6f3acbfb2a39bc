// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>
#include <memory>

#include "mapbuilder/cli/command.h"
#include "mapbuilder/report/write_report.h"

namespace floorloc {
namespace {

struct Arguments {
  std::filesystem::path map;
  std::filesystem::path out;
};

}  // namespace

void AddReportCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("report", "Writes a page on the quality of a map");
  const auto a = std::make_shared<Arguments>();
  command->add_option("map", a->map, "Map file")->required();
  command->add_option("--out", a->out, "Folder for report.html and report.json")->required();
  command->callback([a] {
    const Verdict verdict = WriteReport(a->map, a->out);
    std::cout << (a->out / "report.html").string() << ": " << verdict.headline << "\n";
  });
}

}  // namespace floorloc
