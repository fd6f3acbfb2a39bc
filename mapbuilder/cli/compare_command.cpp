// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/io/text_file.h"
#include "mapbuilder/cli/command.h"
#include "mapbuilder/laboratory/html_report.h"
#include "mapbuilder/laboratory/laboratory.h"

namespace floorloc {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

// Raw command line arguments.
struct Arguments {
  std::vector<std::string> detectors, descriptors, matchers, filters;
  std::vector<std::string> methods = {"features", "contour", "template"};
  bool raw = false;
  std::string pose;
  std::string thresholds;
  double tolerance_mm = 10.0, tolerance_deg = 1.0;
  double jump_cm = 20.0, jump_deg = 10.0;
  double inlier_mm = 3.0;
  bool json = false;
  std::filesystem::path report;
  LaboratoryOptions options;
};

void TranslateMethods(const std::vector<std::string>& methods, LaboratoryOptions* options) {
  const auto asked = [&](const char* name) { return std::find(methods.begin(), methods.end(), name) != methods.end(); };
  options->features = asked("features");
  options->contours = asked("contour");
  options->templates = asked("template");
}

LaboratoryOptions Translate(const Arguments& a) {
  LaboratoryOptions options = a.options;
  options.detectors = ParseDetectors(a.detectors);
  options.descriptors = ParseDescriptors(a.descriptors);
  options.matchers = ParseMatchers(a.matchers);
  options.filters = ParseFilters(a.filters);
  TranslateMethods(a.methods, &options);
  options.normalize = !a.raw;
  if (!a.thresholds.empty()) {
    options.thresholds = a.thresholds == "opencv" ? DetectorSettings::kThesis : DetectorSettings::kLaboratory;
  }
  if (!a.pose.empty()) {
    options.fit = a.pose == "mean" ? PoseFit::kWeightedMean : PoseFit::kLeastSquares;
  }
  options.tolerance = {1e-3 * a.tolerance_mm, kRadPerDeg * a.tolerance_deg};
  options.jump = {1e-2 * a.jump_cm, kRadPerDeg * a.jump_deg};
  options.inlier_radius_m = 1e-3 * a.inlier_mm;
  options.run.progress = ProgressOutput::Stderr();
  return options;
}

void PrintText(const LaboratoryReport& report) {
  std::cout << report.title << "\n";
  for (const std::string& line : report.conditions) {
    std::cout << "  " << line << "\n";
  }
  for (const ResultTable& table : report.tables) {
    std::cout << "\n" << ToText(table);
  }
}

void PrintJson(const LaboratoryReport& report) {
  nlohmann::ordered_json json{
      {"title", report.title}, {"conditions", report.conditions}, {"tables", nlohmann::json::array()}};
  for (const ResultTable& table : report.tables) {
    json["tables"].push_back(ToJson(table));
  }
  std::cout << json.dump(2) << "\n";
}

void Run(const Arguments& a) {
  const LaboratoryOptions options = Translate(a);
  if (!a.report.empty()) {
    CheckWritable(a.report);
  }
  const LaboratoryReport report = RunLaboratory(options);
  if (!a.report.empty()) {
    WriteFileAtomically(a.report, ToHtml(report));
  }
  a.json ? PrintJson(report) : PrintText(report);
}

// Adds an option with a comma-separated list of names; an unknown name is a usage error.
template <typename Kind>
void AddList(CLI::App* command, const std::string& flag, std::vector<std::string>* names,
             std::vector<Kind> (*parse)(const std::vector<std::string>&)) {
  const auto known = [parse](const std::string& name) {
    try {
      parse({name});
      return std::string();
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
  };
  command->add_option(flag, *names, "Names separated by commas, or all")->delimiter(',')->check(known);
}

void AddConditions(CLI::App* command, Arguments* a) {
  LaboratoryOptions& o = a->options;
  command->add_flag("--raw", a->raw, "Leave grey levels as they are; otherwise contrast is normalized first");
  command
      ->add_option("--thresholds", a->thresholds,
                   "Of the detectors: laboratory (sensitive), or opencv (its defaults, SURF 200; for --test 1)")
      ->check(CLI::IsMember({"laboratory", "opencv"}));
  command->add_option("--keypoints", o.keypoints,
                      "Most per frame, the map as dense; 0: no limit. Default 400, without limit for --test 1");
  command->add_option("--ratio", o.ratio, "Of the ratio test. Default 0.75, or the thesis's for --test");
  command->add_option("--pose", a->pose, "How a pose is fitted: least-squares, or mean (the default of --test)")
      ->check(CLI::IsMember({"least-squares", "mean"}));
  command->add_option("--inlier-mm", a->inlier_mm, "Radius of an inlier")->capture_default_str();
  command->add_option("--tolerance-mm", a->tolerance_mm, "Of a success")->capture_default_str();
  command->add_option("--tolerance-deg", a->tolerance_deg, "Of a success")->capture_default_str();
  command->add_option("--jump-cm", a->jump_cm, "Threshold of the jump filter")->capture_default_str();
  command->add_option("--jump-deg", a->jump_deg, "Threshold of the jump filter")->capture_default_str();
  command->add_option("--skip-frames", o.skip_frames, "At the beginning of each folder")->capture_default_str();
  command->add_option("--max-frames", o.max_frames, "Of each folder; 0: all")->capture_default_str();
}

}  // namespace

void AddCompareCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "compare", "The feature laboratory: detectors, descriptors, matchers and filters compared on a floor");
  const auto a = std::make_shared<Arguments>();
  LaboratoryOptions& o = a->options;
  command->add_option("--survey", o.survey, "Survey folder; its groundtruth.tum places the frames if there is one")
      ->required();
  command->add_option("--frames", o.frames, "Folder(s) of frames with groundtruth.tum")->required();
  command
      ->add_option("--test", o.thesis_test,
                   "One of the four tests of the thesis: 1 features, 2 matches, 3 ratios, 4 stills")
      ->check(CLI::Range(1, 4));
  AddList(command, "--detectors", &a->detectors, &ParseDetectors);
  AddList(command, "--descriptors", &a->descriptors, &ParseDescriptors);
  AddList(command, "--matchers", &a->matchers, &ParseMatchers);
  AddList(command, "--filters", &a->filters, &ParseFilters);
  command->add_option("--methods", a->methods, "features, contour (Hu moments), template")
      ->delimiter(',')
      ->check(CLI::IsMember({"features", "contour", "template"}));
  AddConditions(command, a.get());
  command->add_flag("--json", a->json, "Print JSON");
  command->add_option("--report", a->report, "Write a page with plots and tables (HTML)");
  command->add_option("--seed", o.seed, "Seed of FLANN's trees")->capture_default_str();
  command->add_option("--threads", o.run.threads, "Number of threads; 0: one per core")->capture_default_str();
  command->callback([a] { Run(*a); });
}

}  // namespace floorloc
