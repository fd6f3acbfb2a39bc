// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdio>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>
#include <string_view>

#include "core/evaluation/alignment.h"
#include "core/evaluation/association.h"
#include "core/evaluation/trajectory_error.h"
#include "core/io/input_error.h"
#include "core/io/trajectory.h"
#include "mapbuilder/cli/command.h"
#include "mapbuilder/plot_trajectory.h"

namespace floorloc {
namespace {

constexpr double kMmPerM = 1000.0;
constexpr double kDegPerRad = 180.0 / std::numbers::pi;

const std::map<std::string, AlignmentMode> kAlignmentModes = {{"none", AlignmentMode::kNone},
                                                              {"se2", AlignmentMode::kSe2},
                                                              {"se3", AlignmentMode::kSe3},
                                                              {"sim3", AlignmentMode::kSim3}};

struct EvaluateOptions {
  std::string metric;
  std::filesystem::path reference_file;
  std::filesystem::path estimate_file;
  std::string align = "none";
  double max_diff_s = 0.01;
  bool json = false;
  std::filesystem::path plot_file;
};

struct Evaluation {
  std::size_t reference_poses = 0;
  std::size_t estimated_poses = 0;
  Similarity3 alignment;
  std::vector<PosePair> pairs;  ///< aligned
  std::vector<PoseError> errors;
  ErrorStatistics translation;  ///< metres
  ErrorStatistics rotation;     ///< radians
};

using Member = double ErrorStatistics::*;
constexpr std::array<std::pair<const char*, Member>, 8> kStatistics = {{{"rmse", &ErrorStatistics::rmse},
                                                                        {"mean", &ErrorStatistics::mean},
                                                                        {"median", &ErrorStatistics::median},
                                                                        {"std", &ErrorStatistics::std},
                                                                        {"min", &ErrorStatistics::min},
                                                                        {"max", &ErrorStatistics::max},
                                                                        {"sse", &ErrorStatistics::sse},
                                                                        {"p99", &ErrorStatistics::p99}}};

void CheckPairCount(const Evaluation& evaluation, const EvaluateOptions& options) {
  const std::size_t needed = options.metric == "rpe" || options.align != "none" ? 2 : 1;
  if (evaluation.pairs.size() < needed) {
    throw InputError(options.estimate_file, "only " + std::to_string(evaluation.pairs.size()) + " of its " +
                                                std::to_string(evaluation.estimated_poses) + " poses have one of " +
                                                options.reference_file.string() + " within " +
                                                std::to_string(options.max_diff_s) + " s, but " + options.metric +
                                                " needs at least " + std::to_string(needed) +
                                                "; check that both have the same clock, or allow more with --max-diff");
  }
}

ErrorStatistics SummarizeMember(const std::vector<PoseError>& errors, double PoseError::*member) {
  std::vector<double> values;
  for (const PoseError& error : errors) {
    values.push_back(error.*member);
  }
  return Summarize(std::move(values));
}

Evaluation Evaluate(const EvaluateOptions& options) {
  const Trajectory reference = ReadTrajectory(options.reference_file);
  const Trajectory estimate = ReadTrajectory(options.estimate_file);
  Evaluation evaluation;
  evaluation.reference_poses = reference.size();
  evaluation.estimated_poses = estimate.size();
  evaluation.pairs = AssociateByTime(reference, estimate, options.max_diff_s);
  CheckPairCount(evaluation, options);
  try {
    evaluation.alignment = ComputeAlignment(evaluation.pairs, kAlignmentModes.at(options.align));
  } catch (const std::invalid_argument& error) {
    throw InputError(options.estimate_file, error.what());
  }
  evaluation.pairs = Align(std::move(evaluation.pairs), evaluation.alignment);
  evaluation.errors =
      options.metric == "ape" ? AbsolutePoseErrors(evaluation.pairs) : RelativePoseErrors(evaluation.pairs);
  evaluation.translation = SummarizeMember(evaluation.errors, &PoseError::translation_m);
  evaluation.rotation = SummarizeMember(evaluation.errors, &PoseError::rotation_rad);
  return evaluation;
}

nlohmann::ordered_json StatisticsJson(const ErrorStatistics& statistics) {
  nlohmann::ordered_json json;
  for (const auto& [name, member] : kStatistics) {
    json[name] = statistics.*member;
  }
  return json;
}

void PrintJson(const Evaluation& evaluation, const EvaluateOptions& options) {
  const Similarity3& a = evaluation.alignment;
  const nlohmann::ordered_json alignment = {
      {"translation", {a.translation_m.x(), a.translation_m.y(), a.translation_m.z()}},
      {"quaternion_xyzw", {a.rotation.x(), a.rotation.y(), a.rotation.z(), a.rotation.w()}},
      {"scale", a.scale}};
  const nlohmann::ordered_json json = {{"metric", options.metric},
                                       {"align", options.align},
                                       {"pairs", evaluation.pairs.size()},
                                       {"reference_poses", evaluation.reference_poses},
                                       {"estimated_poses", evaluation.estimated_poses},
                                       {"translation", StatisticsJson(evaluation.translation)},
                                       {"rotation", StatisticsJson(evaluation.rotation)},
                                       {"alignment", alignment}};
  std::cout << json.dump(2) << "\n";
}

// A sum of squares scales with the square of the unit.
double InUnit(double value, const char* statistic, double per_si) {
  return value * (std::string_view(statistic) == "sse" ? per_si * per_si : per_si);
}

void PrintTable(const Evaluation& evaluation, const EvaluateOptions& options) {
  std::printf("%s, alignment %s: %zu pairs of %zu reference and %zu estimated poses\n", options.metric.c_str(),
              options.align.c_str(), evaluation.pairs.size(), evaluation.reference_poses, evaluation.estimated_poses);
  std::printf("%-8s %18s %18s\n", "", "translation [mm]", "rotation [deg]");
  for (const auto& [name, member] : kStatistics) {
    std::printf("%-8s %18.4f %18.5f%s\n", name, InUnit(evaluation.translation.*member, name, kMmPerM),
                InUnit(evaluation.rotation.*member, name, kDegPerRad),
                std::string_view(name) == "sse" ? "   (squared units)" : "");
  }
  const Similarity3& a = evaluation.alignment;
  if (options.align != "none") {
    std::printf("estimate moved by (%.6f, %.6f, %.6f) m, turned by %.6f deg, scaled by %.9f\n", a.translation_m.x(),
                a.translation_m.y(), a.translation_m.z(),
                kDegPerRad * Eigen::Quaterniond::Identity().angularDistance(a.rotation), a.scale);
  }
  std::fflush(stdout);
}

void Plot(const Evaluation& evaluation, const EvaluateOptions& options) {
  ErrorPlot plot;
  plot.title =
      options.metric + " of " + options.estimate_file.filename().string() + ", translation, alignment " + options.align;
  plot.unit = "mm";
  // The errors of rpe belong to the ends of the motions: the first pair has none.
  const std::size_t first = evaluation.pairs.size() - evaluation.errors.size();
  for (std::size_t i = 0; i < evaluation.errors.size(); ++i) {
    const PosePair& pair = evaluation.pairs[first + i];
    plot.samples.push_back({ToSeconds(pair.estimate.stamp_ns), pair.reference.translation_m.head<2>(),
                            pair.estimate.translation_m.head<2>(), kMmPerM * evaluation.errors[i].translation_m});
  }
  WriteErrorPlot(options.plot_file, plot);
}

void Run(const EvaluateOptions& options) {
  const Evaluation evaluation = Evaluate(options);
  if (!options.plot_file.empty()) {
    Plot(evaluation, options);
  }
  if (options.json) {
    PrintJson(evaluation, options);
  } else {
    PrintTable(evaluation, options);
  }
}

}  // namespace

void AddEvaluateCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("evaluate", "Trajectory errors, with the definitions of evo.");
  auto options = std::make_shared<EvaluateOptions>();
  command->add_option("metric", options->metric, "ape: error of the poses; rpe: error of the motions between them")
      ->required()
      ->check(CLI::IsMember({"ape", "rpe"}));
  command->add_option("reference", options->reference_file, "true trajectory (TUM, or EuRoC when .csv)")->required();
  command->add_option("estimate", options->estimate_file, "estimated trajectory")->required();
  command->add_option("--align", options->align, "none, se2, se3 or sim3: move the estimate onto the reference first")
      ->check(CLI::IsMember({"none", "se2", "se3", "sim3"}))
      ->capture_default_str();
  command->add_option("--max-diff", options->max_diff_s, "largest time difference of a pair, seconds")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_flag("--json", options->json, "print JSON: metres and radians");
  command->add_option("--plot", options->plot_file, "draw the translation errors into this PNG file");
  command->callback([options] { Run(*options); });
}

}  // namespace floorloc
