// SPDX-License-Identifier: Apache-2.0
// How good is the fused pose, beside simpler ways to fuse? `./run bench fusion` starts it.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <opencv2/core/utility.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "core/localization/localizer.h"
#include "core/map/map_database.h"
#include "tests/bench/fusion/fusion_score.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  fs::path map;
  std::vector<fs::path> drives;
  int repetitions = 5;
};

// One drive under one scenario, several times with other luck.
FusionScore ScoreDrive(const FusionRecording& recording, const FusionScenario& scenario, const FusionVariant& variant,
                       int repetitions) {
  FusionScore score;
  for (int i = 0; i < repetitions; ++i) {
    const std::vector<FusionMessage> messages = MakeMessages(recording, scenario, static_cast<std::uint64_t>(i + 1));
    score.Add(ScoreFusion(ReplayMessages(messages, recording.truth, variant), recording.kidnaps_ns));
  }
  return score;
}

std::string Fixed(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

std::string Percent(std::size_t part, std::size_t all) {
  const double share = all == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(all);
  return Fixed(100.0 * share, share < 0.1 ? 2 : 1);
}

std::string Recoveries(FusionScore score) {
  const std::size_t found = score.recovery_s.size();
  const std::size_t all = found + static_cast<std::size_t>(score.never_recovered);
  if (all == 0) {
    return "";
  }
  if (found == 0) {
    return "never";
  }
  std::sort(score.recovery_s.begin(), score.recovery_s.end());
  const std::string times = Fixed(score.recovery_s[found / 2], 1) + " (" + Fixed(score.recovery_s.back(), 1) + ")";
  return found == all ? times : times + ", " + std::to_string(found) + " of " + std::to_string(all);
}

void PrintRow(const std::string& name, const FusionScore& score) {
  std::cout << "| " << name << " | " << Fixed(1000.0 * score.RmseM(), 1) << " | "
            << Fixed(1000.0 * score.worst_jump_m, 1) << " | " << Recoveries(score) << " | "
            << Percent(score.called_good, score.samples) << " | " << Percent(score.wrong_called_good, score.samples)
            << " | " << (score.MeanNees() < 1000.0 ? Fixed(score.MeanNees(), 1) : "> 1000") << " |\n";
}

void PrintScenario(const FusionScenario& scenario, const std::vector<FusionRecording>& recordings, int repetitions) {
  bool any = false;
  for (const FusionVariant& variant : AllFusionVariants()) {
    FusionScore score;
    for (const FusionRecording& recording : recordings) {
      if (recording.kidnaps_ns.empty() != scenario.kidnapped) {
        score.Add(ScoreDrive(recording, scenario, variant, repetitions));
        any = true;
      }
    }
    if (any) {
      PrintRow(scenario.name + ": " + variant.name, score);
    }
  }
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
  std::cout
      << "| | RMSE, mm | worst jump, mm | found again after a kidnap, s: median (worst) | called good, % | wrong but "
         "called good, % | NEES |\n|---|---:|---:|---:|---:|---:|---:|\n";
  for (const FusionScenario& scenario : AllFusionScenarios()) {
    PrintScenario(scenario, recordings, arguments.repetitions);
  }
  std::cout
      << "Wrong: beyond 50 mm or 3 degrees. Jump: a step of the pose, from one odometry message to the next, beyond "
         "the true\nmotion. The two seconds after a kidnap don't count for RMSE and NEES (3 is exact), the time "
         "until the recovery\nnot for jumps.\n";
}

}  // namespace
}  // namespace floorloc

int main(int argc, char** argv) {
  floorloc::Arguments arguments;
  CLI::App app("Replays drives under several scenarios through every way to fuse, and prints one table.",
               "fusion_benchmark");
  app.add_option("--map", arguments.map, "Map of the drives' floor")->required();
  app.add_option("drives", arguments.drives, "Folders of simulated drives")->required();
  app.add_option("--repetitions", arguments.repetitions, "Times a scenario is replayed, with other luck")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    floorloc::Run(arguments);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "fusion_benchmark: " << error.what() << "\n";
    return 1;
  }
}
