// SPDX-License-Identifier: Apache-2.0
// Localization success against the number of keypoints in the map. `./run bench keypoints` starts it.
#include <CLI/CLI.hpp>
#include <exception>
#include <functional>
#include <iostream>
#include <opencv2/core/utility.hpp>

#include "mapbuilder/batch/progress.h"
#include "tests/bench/common/state_folder.h"
#include "tests/bench/keypoints/keypoint_table.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string state;
  std::string photograph;
  int frames = 30;
  std::vector<double> budgets{250, 500, 1000, 2000, 4000, 6000};
  std::vector<fs::path> folders;
};

std::vector<KeypointTally> MakeTallies(const std::vector<double>& budgets) {
  std::vector<KeypointTally> tallies;
  for (const double budget : budgets) {
    for (const PruningRule rule : AllPruningRules()) {
      tallies.push_back({rule, budget, 0, 0, 0.0, {}});
    }
  }
  return tallies;
}

// Scenes are made one after the other to save memory.
using SceneMakers = std::vector<std::function<Scene()>>;

SceneMakers MakeSceneMakers(const Arguments& arguments) {
  if (!arguments.folders.empty()) {
    const std::vector<fs::path> frames(arguments.folders.begin() + 1, arguments.folders.end());
    return {[survey = arguments.folders.front(), frames] { return ReadScene(survey, frames); }};
  }
  SceneMakers makers;
  for (const FloorCase& floor : SceneFloors(arguments.photograph)) {
    makers.emplace_back([=] { return SimulateScene(fs::path(arguments.state) / floor.name, floor, arguments.frames); });
  }
  return makers;
}

void Run(const Arguments& arguments) {
  cv::setNumThreads(1);
  ClearStateFolder(arguments.state, "keypoint_benchmark");
  const SceneMakers makers = MakeSceneMakers(arguments);
  std::vector<KeypointTally> tallies = MakeTallies(arguments.budgets);
  std::vector<std::string> groups;
  ProgressBar progress("keypoints", static_cast<std::int64_t>(makers.size() * tallies.size()),
                       ProgressOutput::Stderr());
  for (const auto& make_scene : makers) {
    const Scene scene = make_scene();
    groups.clear();
    for (const FrameGroup& group : scene.groups) {
      groups.push_back(group.name);
    }
    TryBudgets(scene, arguments.state, &tallies, [&progress] { progress.Advance(); });
  }
  std::cout << "kB: of the map file without its mosaic. inliers: keypoints that agree with the right pose; 0 where it "
               "was not found.\nsuccess: within 10 mm and 1 degree of the truth, the whole map searched, or near a "
               "prior. wrong: accepted, but beyond,\nof both searches. error: of the successes with a prior.\n";
  PrintTable(std::cout, tallies, groups);
}

}  // namespace
}  // namespace floorloc

int main(int argc, char** argv) {
  floorloc::Arguments arguments;
  CLI::App app("Prunes maps to budgets by several rules, localizes frames in them and prints one table.",
               "keypoint_benchmark");
  app.add_option("--state", arguments.state, "Folder of floors and maps; what is there is lost")->required();
  app.add_option("--photograph", arguments.photograph, "Image of a floor to make one of")->required();
  app.add_option("--frames", arguments.frames, "Mild and as many hard frames per simulated floor")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--budgets", arguments.budgets, "Keypoints per m2")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("folders", arguments.folders, "SURVEY FRAMES...: recorded ones instead of simulated floors");
  CLI11_PARSE(app, argc, argv);
  try {
    if (arguments.folders.size() == 1) {
      throw std::invalid_argument("give a survey folder and at least one folder of frames, or nothing");
    }
    floorloc::Run(arguments);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "keypoint_benchmark: " << error.what() << "\n";
    return 1;
  }
}
