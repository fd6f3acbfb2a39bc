// SPDX-License-Identifier: Apache-2.0
// Repeats the comparison of Wietrzykowski and Belter (JAMRIS 2014, tables 1 to 3) on simulated scenes, and compares
// groups of features on labelled pictures.
#include <CLI/CLI.hpp>
#include <exception>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "mapbuilder/surface/labelled_picture.h"
#include "tests/bench/surface/picture_trial.h"
#include "tests/bench/surface/scene_trial.h"

namespace floorloc {
namespace {

struct Arguments {
  SceneTrialOptions scenes;
  std::filesystem::path pictures;
  std::filesystem::path picture_of_scene;
};

void PrintConfusion(const Confusion& confusion, const std::vector<std::string>& classes) {
  std::cout << "\n| marked as |";
  for (const std::string& name : classes) {
    std::cout << " " << name << " |";
  }
  std::cout << "\n|---|";
  for (std::size_t i = 0; i < classes.size(); ++i) {
    std::cout << "---:|";
  }
  std::cout << "\n";
  for (int r = 0; r < confusion.classes(); ++r) {
    std::cout << "| " << classes[static_cast<std::size_t>(r)] << " |";
    for (int c = 0; c < confusion.classes(); ++c) {
      std::cout << " " << 100.0 * confusion.Share(r, c) << " |";
    }
    std::cout << "\n";
  }
}

void TryScenes(const SceneTrialOptions& options) {
  const std::vector<std::string> classes = SceneClasses();
  const SceneSamples samples = MakeSceneSamples(options);
  std::cout << options.training_scenes << " scenes to train (" << samples.training.size() << " segments), "
            << options.test_scenes << " to test; pixels right, %\n\n| configuration |";
  for (const std::string& name : classes) {
    std::cout << " " << name << " |";
  }
  std::cout << " average | the paper's | train, s | classify, ms |\n|---|";
  for (std::size_t i = 0; i < classes.size() + 4; ++i) {
    std::cout << "---:|";
  }
  std::cout << "\n" << std::fixed << std::setprecision(1);
  SceneScore whole;
  for (const Configuration& configuration : PaperConfigurations()) {
    const SceneScore score = Try(configuration, samples, options);
    std::cout << "| " << configuration.name << " |";
    for (int c = 0; c < score.pixels.classes(); ++c) {
      std::cout << " " << 100.0 * score.pixels.Share(c, c) << " |";
    }
    std::cout << " " << 100.0 * score.pixels.MeanShare() << " | ";
    if (configuration.paper_percent > 0.0) {
      std::cout << configuration.paper_percent;
    }
    std::cout << " | " << score.training_s << " | " << 1e3 * score.classification_s << " |\n" << std::flush;
    if (configuration.name == "C_kl") {
      whole = score;
    }
  }
  std::cout << "\nC_kl, %:\n";
  PrintConfusion(whole.pixels, classes);
  const StageTimes times = TimeStages(options);
  const double total = times.segmentation_s + times.features_s + whole.classification_s;
  constexpr double kPaperS = 1.791;
  std::cout << "\n| 640 x 480, one core | ms | the paper's, ms |\n|---|---:|---:|\n| segmentation | "
            << 1e3 * times.segmentation_s << " | 1387 |\n| features | " << 1e3 * times.features_s
            << " | 144 |\n| classification | " << 1e3 * whole.classification_s << " | 260 |\n| total | " << 1e3 * total
            << " | 1791 (" << kPaperS / total << " times as long) |\n";
}

// A scene, its classes, side by side.
void WriteScene(const SceneTrialOptions& options, const std::filesystem::path& file) {
  const SurfaceScene scene = SimulateScene(options.scene, options.seed);
  cv::Mat both;
  cv::hconcat(scene.image.color, TintByClass(scene.image.color, scene.class_of_pixel, SceneClasses()), both);
  cv::imwrite(file.string(), both);
}

void Run(const Arguments& a) {
  if (!a.picture_of_scene.empty()) {
    WriteScene(a.scenes, a.picture_of_scene);
  }
  TryScenes(a.scenes);
  if (!a.pictures.empty()) {
    PictureTrialOptions options;
    options.folder = a.pictures;
    options.boosting = a.scenes.boosting;
    options.run = a.scenes.run;
    TryPictures(options, std::cout);
  }
}

}  // namespace
}  // namespace floorloc

int main(int argc, char** argv) {
  CLI::App app("Surface classes: the paper's comparison on simulated scenes, and pictures of your own");
  floorloc::Arguments a;
  app.add_option("--training-scenes", a.scenes.training_scenes)->capture_default_str();
  app.add_option("--test-scenes", a.scenes.test_scenes)->capture_default_str();
  app.add_option("--seed", a.scenes.seed)->capture_default_str();
  app.add_option("--rounds", a.scenes.boosting.rounds, "Of boosting")->capture_default_str();
  app.add_option("--pictures", a.pictures, "Folder with a folder of pictures per class, to cross-validate");
  app.add_option("--scene", a.picture_of_scene, "Write a simulated scene with its classes there");
  app.add_option("--threads", a.scenes.run.threads, "0: one per core")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);
  try {
    using enum floorloc::FeatureGroup;
    a.scenes.features.groups = floorloc::PaperGroups();
    for (const auto group : {kShape, kPattern, kGradient}) {
      a.scenes.features.groups.push_back(group);
    }
    constexpr float kMaxIntensity = 15.0F;  // of the lidar: 99 % of smooth wood are below 10
    a.scenes.features.max_intensity = kMaxIntensity * static_cast<float>(floorloc::kIntensityUnits);
    a.scenes.boosting.threads = a.scenes.run.threads;
    a.scenes.run.progress = floorloc::ProgressOutput::Stderr();
    floorloc::Run(a);
  } catch (const std::exception& error) {
    std::cerr << "surface_benchmark: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
