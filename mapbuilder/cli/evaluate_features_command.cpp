// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <system_error>

#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "mapbuilder/cli/command.h"
#include "mapbuilder/laboratory/adaptive_evaluation.h"
#include "mapbuilder/laboratory/feature_evaluation.h"
#include "mapbuilder/laboratory/html_report.h"

namespace floorloc {
namespace {

// Raw command line arguments.
struct Arguments {
  std::vector<std::string> images;
  std::vector<std::string> features;
  int images_per_set = 5;
  bool json = false;
  std::filesystem::path out;
  FeatureEvaluationOptions options;
  AdaptiveEvaluationOptions adaptive;
  std::vector<std::filesystem::path> drives;
};

FeatureEvaluationOptions Translate(const Arguments& a) {
  FeatureEvaluationOptions options = a.options;
  if (a.drives.size() > 1) {
    throw std::invalid_argument("one --drive is evaluated at a time; several are for --adaptive");
  }
  options.drive = a.drives.empty() ? "" : a.drives.front();
  for (const std::string& text : a.images) {
    options.sets.push_back(ParseImageSet(text, a.images_per_set));
  }
  if (!a.features.empty()) {
    options.features = ParseDetectors(a.features);
  }
  options.image_folder = a.out;
  options.run.progress = ProgressOutput::Stderr();
  return options;
}

std::string ToText(const LaboratoryReport& report) {
  std::string text = report.title + "\n";
  for (const std::string& line : report.conditions) {
    text += "  " + line + "\n";
  }
  for (const ResultTable& table : report.tables) {
    text += "\n" + ToText(table);
  }
  return text;
}

std::string ToJsonText(const LaboratoryReport& report) {
  nlohmann::ordered_json json{
      {"title", report.title}, {"conditions", report.conditions}, {"tables", nlohmann::json::array()}};
  for (const ResultTable& table : report.tables) {
    json["tables"].push_back(ToJson(table));
  }
  return json.dump(2) + "\n";
}

LaboratoryReport Evaluate(const Arguments& a) {
  if (a.adaptive.classifier.empty()) {
    return EvaluateFeatures(Translate(a));
  }
  if (a.drives.empty()) {
    throw std::invalid_argument("--adaptive needs at least one --drive");
  }
  AdaptiveEvaluationOptions options = a.adaptive;
  options.drives = a.drives;
  options.samples.seed = options.training.seed = a.options.seed;
  options.drive.progress = ProgressOutput::Stderr();
  return EvaluateAdaptive(options);
}

void Run(const Arguments& a) {
  if (!a.out.empty()) {
    std::error_code error;
    std::filesystem::create_directories(a.out, error);
    CheckWritable(a.out / "index.html");
  }
  const LaboratoryReport report = Evaluate(a);
  if (!a.out.empty()) {
    WriteFileAtomically(a.out / "index.html", ToHtml(report));
    WriteFileAtomically(a.out / "tables.json", ToJsonText(report));
  }
  std::cout << (a.json ? ToJsonText(report) : ToText(report));
}

}  // namespace

void AddEvaluateFeaturesCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("evaluate-features",
                         "Features for visual odometry: time, matches under shadow, fog, brightness and rotation, "
                         "matches with following frames, how these depend on the number of features, and "
                         "the paths of monocular odometry");
  const auto a = std::make_shared<Arguments>();
  FeatureEvaluationOptions& o = a->options;
  command->add_option("--images", a->images,
                      "Sets of images, each NAME=PATH[,PATH...]: images, folders of images, or a folder of such "
                      "folders, of which the first images are taken");
  command->add_option("--sequence", o.sequences, "Folder(s) of images in a row, or in the survey format");
  command->add_option("--drive", a->drives, "Folder(s) in the survey format with groundtruth.tum, for the paths");
  CLI::Option* adaptive = command->add_option(
      "--adaptive", a->adaptive.classifier,
      "Instead: detectors chosen by the floor's texture, on the --drive folders; a model of 'train-surface --texture', "
      "or a folder to train one on as there");
  command
      ->add_option("--fast-threshold", a->adaptive.drive.detectors.fast_threshold,
                   "With --adaptive: of FAST, grey levels")
      ->needs(adaptive)
      ->check(CLI::Range(1, 254))
      ->capture_default_str();
  command->add_option("--features", a->features, "orb, akaze, brisk, sift, surf; default: all")->delimiter(',');
  command->add_option("--count", o.features_per_image, "Features wanted in the images of --images")
      ->capture_default_str();
  command->add_option("--counts", o.features_of_sequences, "Features wanted in the first image of --sequence")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--pictures", a->images_per_set, "Most of a set, spread evenly over it")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--following", o.following_frames, "Images after the first of a sequence")->capture_default_str();
  command->add_option("--seed", o.seed, "Of shadows, fog and brightness")->capture_default_str();
  command->add_flag("--json", a->json, "Print JSON");
  command->add_option("--out", a->out, "Write a page (index.html), tables.json and images of matches and paths there");
  command->callback([a] { Run(*a); });
}

}  // namespace floorloc
