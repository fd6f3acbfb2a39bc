// SPDX-License-Identifier: Apache-2.0
// Views of a map's floor, of other floors and of none: what the texture tells. `./run bench floor-check` starts it.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <iostream>
#include <opencv2/core/utility.hpp>

#include "mapbuilder/batch/progress.h"
#include "tests/bench/common/state_folder.h"
#include "tests/bench/floor_check/floor_trial.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string state;
  std::string photograph;
  int frames = 40;
  int strange_images = 40;
  std::vector<std::string> strange;
  std::vector<fs::path> folders;
};

struct NamedScene {
  std::string name;
  Scene scene;
};

// A folder with survey/ and folders of frames.
Scene ReadRecorded(const fs::path& folder) {
  std::vector<fs::path> frames;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().filename() != "survey" && fs::exists(entry.path() / "groundtruth.tum")) {
      frames.push_back(entry.path());
    }
  }
  std::sort(frames.begin(), frames.end());
  Scene scene = ReadScene(folder / "survey", frames);
  for (FrameGroup& group : scene.groups) {
    group.name = fs::path(group.name).filename().string();
  }
  return scene;
}

std::vector<NamedScene> Scenes(const Arguments& arguments) {
  std::vector<NamedScene> scenes;
  for (const fs::path& folder : arguments.folders) {
    scenes.push_back({folder.filename().string(), ReadRecorded(folder)});
  }
  if (arguments.folders.empty()) {
    for (const FloorCase& floor : SceneFloors(arguments.photograph)) {
      scenes.push_back({floor.name, SimulateScene(fs::path(arguments.state) / floor.name, floor, arguments.frames)});
    }
  }
  return scenes;
}

// Each floor's first frames are strange to all other maps.
std::vector<StrangeViews> StrangeToSome(const Arguments& arguments, const std::vector<NamedScene>& scenes) {
  const FloorCamera& camera = scenes.front().scene.groups.front().camera;
  const cv::Size raw_px(camera.camera.width_px, camera.camera.height_px);
  std::vector<StrangeViews> strange;
  for (const NamedScene& named : scenes) {
    StrangeViews& views = strange.emplace_back();
    views.name = named.name;
    for (const SceneFrame& frame : named.scene.groups.back().frames) {
      if (frame.raw.size() == raw_px && static_cast<int>(views.images.size()) < arguments.strange_images) {
        views.images.push_back(frame.raw);
      }
    }
  }
  for (StrangeViews& views : SimulatedStrangeViews(raw_px)) {
    strange.push_back(std::move(views));
  }
  for (const std::string& text : arguments.strange) {
    const auto equals = text.find('=');
    strange.push_back(
        ReadStrangeViews(text.substr(0, equals), text.substr(equals + 1), raw_px, arguments.strange_images));
  }
  return strange;
}

void Print(const std::vector<FloorRow>& rows) {
  std::printf("%-20s %-26s %6s %13s %15s %15s %9s %9s\n", "map", "views", "images", "localized", "refused: no/oth",
              "named: no/other", "search ms", "refuse ms");
  for (const FloorRow& row : rows) {
    std::printf("%-20s %-26s %6d %6d %6d %8d %6d %8d %6d %9.2f %9.2f\n", row.map.c_str(), row.views.c_str(), row.images,
                row.found_before, row.found_after, row.no_floor_refused, row.other_floor_refused, row.no_floor_named,
                row.other_floor_named, row.before_ms, row.refused_ms);
  }
}

void Run(const Arguments& arguments) {
  cv::setNumThreads(1);
  ClearStateFolder(arguments.state, "floor_benchmark");
  const std::vector<NamedScene> scenes = Scenes(arguments);
  const std::vector<StrangeViews> strange = StrangeToSome(arguments, scenes);
  std::vector<FloorRow> rows;
  ProgressBar progress("floors", static_cast<std::int64_t>(scenes.size()), ProgressOutput::Stderr());
  for (const NamedScene& named : scenes) {
    for (FloorRow& row :
         TryFloor(named.name, named.scene, strange, fs::path(arguments.state) / (named.name + ".floormap"))) {
      rows.push_back(std::move(row));
    }
    progress.Advance();
  }
  std::cout << "Localized, or ambiguous, where every view is searched for, and where its texture is looked at first. "
               "Refused: before the\nsearch, as no floor or another one. Named: after a search in vain. search: "
               "median time beside that of the features, of\nviews that are not localized; refuse: of those that are "
               "refused.\n";
  Print(rows);
}

}  // namespace
}  // namespace floorloc

int main(int argc, char** argv) {
  floorloc::Arguments arguments;
  CLI::App app("Shows maps of floors views of other floors, of none, and their own.", "floor_benchmark");
  app.add_option("--state", arguments.state, "Folder of floors and maps; what is there is lost")->required();
  app.add_option("--photograph", arguments.photograph, "Image of a floor to make one of")->required();
  app.add_option("--frames", arguments.frames, "Mild and as many hard frames per simulated floor")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--strange", arguments.strange, "NAME=FOLDER: images that show none of the floors")
      ->allow_extra_args(false);
  app.add_option("--strange-images", arguments.strange_images, "Most of each kind")->capture_default_str();
  app.add_option("folders", arguments.folders,
                 "Recorded floors instead of simulated ones: each has survey/ and folders of frames with truth");
  CLI11_PARSE(app, argc, argv);
  try {
    floorloc::Run(arguments);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "floor_benchmark: " << error.what() << "\n";
    return 1;
  }
}
