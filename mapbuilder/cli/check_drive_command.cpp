// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/map/map_database.h"
#include "mapbuilder/cli/command.h"
#include "mapbuilder/replay/drive_check.h"

namespace floorloc {
namespace {

struct Arguments {
  std::filesystem::path map, frames;
  bool json = false;
};

void Print(const std::vector<Finding>& findings) {
  for (const Finding& finding : findings) {
    std::printf("%-8s %-9s %s\n", finding.status == FindingStatus::kWrong ? "WRONG" : ToString(finding.status),
                finding.about.c_str(), finding.sentence.c_str());
    if (!finding.cure.empty()) {
      std::printf("%-8s %-9s -> %s\n", "", "", finding.cure.c_str());
    }
  }
}

void PrintJson(const std::vector<Finding>& findings) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Finding& finding : findings) {
    list.push_back({{"about", finding.about},
                    {"status", ToString(finding.status)},
                    {"sentence", finding.sentence},
                    {"cure", finding.cure}});
  }
  std::cout << nlohmann::ordered_json{{"status", ToString(WorstOf(findings))}, {"findings", std::move(list)}}.dump(2)
            << "\n";
}

void Run(const Arguments& a) {
  const Survey drive = ReadSurvey(a.frames);
  const MapDatabase database(a.map);
  const Localizer localizer(database.ReadMap(), LocalizerOptions(),
                            [&](const TileId& tile) { return database.ReadMosaicTile(tile); });
  FuseFramesOptions options;
  options.run.progress = ProgressOutput::Stderr();
  const std::vector<Finding> findings = CheckDrive(drive, FuseFrames(localizer, WithoutForeignClocks(drive), options));
  a.json ? PrintJson(findings) : Print(findings);
  if (WorstOf(findings) == FindingStatus::kWrong) {
    throw CLI::RuntimeError(kRobotIsWrong);
  }
}

}  // namespace

void AddCheckDriveCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("check-drive",
                         "Says what is wrong with a robot by a recorded drive: camera, odometry, clock, "
                         "gyro; exit code 3 when something is");
  const auto a = std::make_shared<Arguments>();
  command->add_option("--map", a->map, "Map file")->required();
  command->add_option("--frames", a->frames, "Recorded drive, a folder in the survey format")->required();
  command->add_flag("--json", a->json, "Print JSON");
  command->callback([a] { Run(*a); });
}

}  // namespace floorloc
