// SPDX-License-Identifier: Apache-2.0
// Compares all extractors of this build on simulated or recorded floors. `./run bench extractors` starts it.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <functional>
#include <iostream>
#include <opencv2/core/utility.hpp>
#include <optional>

#include "mapbuilder/batch/progress.h"
#include "mapbuilder/surface/texture_training.h"
#include "tests/bench/common/state_folder.h"
#include "tests/bench/extractors/chosen_extractor.h"
#include "tests/bench/extractors/extractor_trial.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string state;
  std::string photograph;
  int frames = 40;
  std::vector<std::string> only;
  fs::path texture_model;
  std::vector<std::string> stripes;
  std::vector<fs::path> folders;
};

std::vector<std::string> NamesOfThisBuild() {
  std::vector<std::string> names;
  for (const ExtractorType type : AllExtractorTypes()) {
    names.emplace_back(ToString(type));
  }
  return names;
}

std::vector<ExtractorVariant> SelectVariants(const std::vector<std::string>& only) {
  std::vector<ExtractorVariant> variants = ExtractorVariants();
  std::erase_if(variants, [&](const ExtractorVariant& variant) {
    return !only.empty() && std::find(only.begin(), only.end(), ToString(variant.options.type)) == only.end();
  });
  return variants;
}

std::vector<FloorCase> FloorsOf(const Arguments& arguments) {
  std::vector<FloorCase> floors = SceneFloors(arguments.photograph);
  if (arguments.stripes.empty()) {
    return floors;
  }
  constexpr double kStripeM = 0.5;  // an image shows 0.4 m
  FloorCase striped = floors.front();
  striped.name = "stripes";
  striped.texture.source = arguments.stripes[0];
  striped.texture.stripes = arguments.stripes[1];
  striped.texture.stripe_m = kStripeM;
  return {striped};
}

// Scenes are made one after the other to save memory.
using SceneMakers = std::vector<std::function<Scene()>>;

SceneMakers MakeSceneMakers(const Arguments& arguments) {
  if (!arguments.folders.empty()) {
    const std::vector<fs::path> frames(arguments.folders.begin() + 1, arguments.folders.end());
    return {[survey = arguments.folders.front(), frames] { return ReadScene(survey, frames); }};
  }
  SceneMakers makers;
  for (const FloorCase& floor : FloorsOf(arguments)) {
    makers.emplace_back([=] { return SimulateScene(fs::path(arguments.state) / floor.name, floor, arguments.frames); });
  }
  return makers;
}

void PrintExplanation(const Arguments& arguments) {
  const std::string floors =
      "Five simulated floors of 2.2 x 1.6 m: concrete, carpet, wood, a quilted photograph, "
      "tiles that are nearly alike.";
  std::cout << (arguments.folders.empty() ? floors : "Map of " + arguments.folders.front().string() + ".")
            << "\nextract: contrast and features of a frame, median of the thread's time. bytes: of a keypoint in the "
               "map file.\ninliers: keypoints that agree with the right pose; 0 where it was not found. success: "
               "within 10 mm and 1 degree\nof the truth, the whole map searched, or near a prior (up to 0.24 m and 14 "
               "degrees off). wrong: accepted, but beyond,\nof both searches. error, heading: median and 99 % of the "
               "successes with a prior.\n";
}

void Run(const Arguments& arguments) {
  cv::setNumThreads(1);
  const std::vector<ExtractorVariant> variants = SelectVariants(arguments.only);
  const SceneMakers makers = MakeSceneMakers(arguments);
  std::optional<TextureClassifier> classifier;
  if (!arguments.texture_model.empty()) {
    classifier = ReadTextureModel(arguments.texture_model);
  }
  TexturesByGroup textures;
  ClearStateFolder(arguments.state, "extractor_benchmark");
  std::vector<ExtractorTally> tallies(variants.size());
  std::vector<std::string> groups;
  ProgressBar progress("extractors", static_cast<std::int64_t>(makers.size() * variants.size()),
                       ProgressOutput::Stderr());
  for (const auto& make_scene : makers) {
    const Scene scene = make_scene();
    groups.clear();
    for (const FrameGroup& group : scene.groups) {
      groups.push_back(group.name);
    }
    if (classifier) {
      AssessFrames(scene, *classifier, &textures);
    }
    for (std::size_t i = 0; i < variants.size(); ++i) {
      tallies[i].name = variants[i].name;
      TryExtractor(variants[i], scene, fs::path(arguments.state) / "bench.floormap", &tallies[i]);
      progress.Advance();
    }
  }
  PrintExplanation(arguments);
  PrintTable(std::cout, tallies, groups);
  if (classifier) {
    PrintChoices(std::cout, tallies, textures);
  }
}

}  // namespace
}  // namespace floorloc

int main(int argc, char** argv) {
  floorloc::Arguments arguments;
  CLI::App app("Builds maps with every feature extractor, localizes frames in them and prints one table.",
               "extractor_benchmark");
  app.add_option("--state", arguments.state, "Folder of floors and maps; what is there is lost")->required();
  app.add_option("--photograph", arguments.photograph, "Image of a floor to make one of")->required();
  app.add_option("--frames", arguments.frames, "Mild and as many hard frames per simulated floor")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--only", arguments.only, "Extractors to try (default: all)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(floorloc::NamesOfThisBuild()));
  app.add_option("--texture-model", arguments.texture_model,
                 "Of train-surface --texture: also pairs of extractors of which it chooses one for each frame");
  app.add_option("--stripes", arguments.stripes, "One simulated floor instead of five: stripes of two textures")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->expected(2);
  app.add_option("folders", arguments.folders, "SURVEY FRAMES...: recorded ones instead of simulated floors");
  CLI11_PARSE(app, argc, argv);
  try {
    if (arguments.folders.size() == 1) {
      throw std::invalid_argument("give a survey folder and at least one folder of frames, or nothing");
    }
    floorloc::Run(arguments);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "extractor_benchmark: " << error.what() << "\n";
    return 1;
  }
}
