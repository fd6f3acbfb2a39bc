// SPDX-License-Identifier: Apache-2.0
// Accuracy of the fused pose, compared with simpler fusion methods. `./run bench fusion` starts it.
#include <CLI/CLI.hpp>
#include <exception>
#include <filesystem>
#include <iostream>
#include <opencv2/core/utility.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/localization/localizer.h"
#include "core/map/map_database.h"
#include "tests/bench/fusion/fault_table.h"
#include "tests/bench/fusion/fusion_table.h"
#include "tests/bench/fusion/sensor_fault.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  fs::path map;
  std::vector<fs::path> drives;
  int repetitions = 5;
  bool faults = false;
};

// Scores one drive under one scenario over several random seeds.
FusionScore ScoreDrive(const FusionRecording& recording, const FusionScenario& scenario, const FusionVariant& variant,
                       int repetitions) {
  FusionScore score;
  for (int i = 0; i < repetitions; ++i) {
    const std::vector<FusionMessage> messages = MakeMessages(recording, scenario, static_cast<std::uint64_t>(i) + 1);
    score.Add(ScoreFusion(ReplayMessages(messages, recording.truth, variant), recording.kidnaps_ns));
  }
  return score;
}

FusionRow RunScenario(const FusionScenario& scenario, const std::vector<FusionRecording>& recordings,
                      const std::vector<FusionVariant>& variants, int repetitions) {
  FusionRow row{scenario.name, {}};
  for (const FusionVariant& variant : variants) {
    FusionScore score;
    for (const FusionRecording& recording : recordings) {
      if (recording.kidnaps_ns.empty() != scenario.kidnapped) {
        score.Add(ScoreDrive(recording, scenario, variant, repetitions));
      }
    }
    row.scores.push_back(score);
  }
  return row;
}

FaultRow RunFault(const SensorFault& fault, int keep_every, const std::vector<FusionRecording>& recordings,
                  const std::vector<FusionVariant>& variants) {
  constexpr double kImagesPerS = 5.0;  // of the drives
  FaultRow row{fault.name, kImagesPerS / keep_every, {}};
  for (const FusionVariant& variant : variants) {
    FaultScore score;
    for (const FusionRecording& recording : recordings) {
      if (recording.kidnaps_ns.empty()) {
        score.Add(ReplayFault(recording, MakeFaultyMessages(recording, fault, keep_every), variant));
      }
    }
    row.scores.push_back(score);
  }
  return row;
}

void RunFaults(const std::vector<FusionRecording>& recordings) {
  const std::vector<FusionVariant> variants = AllFaultVariants();
  std::vector<FaultRow> rows;
  for (const int keep_every : {1, 5, 25}) {
    for (const SensorFault& fault : AllSensorFaults()) {
      rows.push_back(RunFault(fault, keep_every, recordings, variants));
    }
  }
  PrintFaultTable(std::cout, variants, rows);
}

void Run(const Arguments& arguments) {
  cv::setNumThreads(1);
  const MapDatabase database(arguments.map);
  const Localizer localizer(database.ReadMap(), LocalizerOptions(),
                            [&database](const TileId& tile) { return database.ReadMosaicTile(tile); });
  std::vector<FusionRecording> recordings;
  for (const fs::path& drive : arguments.drives) {
    recordings.push_back(ReadFusionRecording(localizer, drive));
  }
  if (arguments.faults) {
    RunFaults(recordings);
    return;
  }
  const std::vector<FusionVariant> variants = AllFusionVariants();
  std::vector<FusionRow> rows;
  for (const FusionScenario& scenario : AllFusionScenarios()) {
    FusionRow row = RunScenario(scenario, recordings, variants, arguments.repetitions);
    if (row.scores.front().samples > 0) {  // there are drives for this scenario
      rows.push_back(std::move(row));
    }
  }
  PrintFusionTables(std::cout, variants, rows);
}

}  // namespace
}  // namespace floorloc

int main(int argc, char** argv) {
  floorloc::Arguments arguments;
  CLI::App app("Replays drives under several scenarios through every way to fuse, and prints tables.",
               "fusion_benchmark");
  app.add_option("--map", arguments.map, "Map of the drives' floor")->required();
  app.add_option("drives", arguments.drives, "Folders of simulated drives")->required();
  app.add_option("--repetitions", arguments.repetitions, "Times a scenario is replayed, with other luck")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_flag("--faults", arguments.faults, "Instead: what a vehicle is told while its odometry is faulty");
  CLI11_PARSE(app, argc, argv);
  try {
    floorloc::Run(arguments);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "fusion_benchmark: " << error.what() << "\n";
    return 1;
  }
}
