// SPDX-License-Identifier: Apache-2.0
// Compares steered with upright descriptors on simulated floors. `./run bench descriptors` starts it.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <opencv2/core/utility.hpp>

#include "core/io/survey.h"
#include "mapbuilder/build/build_map.h"
#include "tests/bench/common/score.h"
#include "tests/bench/common/state_folder.h"
#include "tests/bench/descriptors/descriptor_trial.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string state;
  std::string photograph;
  int frames = 20;
  std::vector<std::string> only;
};

void PrintRow(const std::string& name, const DescriptorScore& score) {
  std::cout << "  " << std::setw(22) << std::left << name << std::right << std::fixed << std::setprecision(1)
            << std::setw(8) << 100.0 * score.RankOneShare() << std::setprecision(2) << std::setw(12)
            << 1e4 * score.FalseShareAtRecall(0.8) << std::setw(12) << 1e4 * score.FalseShareAtRecall(0.5) << "\n";
}

void Print(const std::string& name, const DescriptorTally& tally) {
  const auto percent = [](std::int64_t part, std::int64_t whole) {
    return 100.0 * static_cast<double>(part) / static_cast<double>(std::max(whole, std::int64_t{1}));
  };
  std::cout << std::fixed << std::setprecision(0) << name << ": " << percent(tally.repeated, tally.keypoints)
            << " % of the keypoints are in the map; the angles of " << percent(tally.angles_within_10, tally.repeated)
            << " % of these are within 10 degrees\n";
  PrintRow("own angle", tally.steered);
  for (const auto& [error, score] : tally.upright) {
    PrintRow("heading, " + std::to_string(error) + " degrees off", score);
  }
}

void Run(const Arguments& arguments) {
  cv::setNumThreads(1);
  ClearStateFolder(arguments.state, "descriptor_benchmark");
  std::cout << "Keypoints of a frame against all of the map. Rank 1: the nearest descriptor is at the true place, %. "
               "False: of 10,000 keypoints\nelsewhere, those as near as 80 % and 50 % of the true ones.\n"
            << std::setw(32) << "rank 1" << std::setw(12) << "false, 80 %" << std::setw(12) << "50 %\n";
  for (const FloorCase& floor : SceneFloors(arguments.photograph)) {
    const bool wanted = arguments.only.empty() ||
                        std::find(arguments.only.begin(), arguments.only.end(), floor.name) != arguments.only.end();
    if (!wanted) {
      continue;
    }
    const Scene scene = SimulateScene(fs::path(arguments.state) / floor.name, floor, arguments.frames);
    BuildOptions options;
    options.surveys = {scene.survey};
    options.out = fs::path(arguments.state) / (floor.name + ".floormap");
    BuildMap(options);
    const MapDatabase database(options.out);
    const Trajectory truth = ReadSurvey(scene.survey).ground_truth;
    const Pose2 map_from_truth = AlignMapToTruth(database.ReadFrames(), truth).Inverse();
    for (const FrameGroup& group : scene.groups) {
      Print(floor.name + ", " + group.name, TryDescriptors(database, group, map_from_truth));
    }
  }
}

}  // namespace
}  // namespace floorloc

int main(int argc, char** argv) {
  floorloc::Arguments arguments;
  CLI::App app("Compares descriptors at the keypoints' own angles with those at a known heading.",
               "descriptor_benchmark");
  app.add_option("--state", arguments.state, "Folder of floors and maps; what is there is lost")->required();
  app.add_option("--photograph", arguments.photograph, "Image of a floor to make one of")->required();
  app.add_option("--frames", arguments.frames, "Mild and as many hard frames per floor")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--only", arguments.only, "Floors: concrete, carpet, wood, photo, tiles (default: all)")
      ->delimiter(',')
      ->allow_extra_args(false);
  CLI11_PARSE(app, argc, argv);
  try {
    floorloc::Run(arguments);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "descriptor_benchmark: " << error.what() << "\n";
    return 1;
  }
}
