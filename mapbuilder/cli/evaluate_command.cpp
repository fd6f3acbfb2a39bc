// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdio>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "core/evaluation/trajectory_evaluation.h"
#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "core/io/trajectory.h"
#include "mapbuilder/cli/command.h"
#include "mapbuilder/plot/plot_trajectory.h"

namespace floorloc {
namespace {

constexpr double kMmPerM = 1000.0;
constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr double kMaxOffsetS = 1e9;

const std::map<std::string, AlignmentMode> kAlignmentModes = {
    {"none", AlignmentMode::kNone}, {"se2", AlignmentMode::kSe2},     {"se3", AlignmentMode::kSe3},
    {"sim3", AlignmentMode::kSim3}, {"scale", AlignmentMode::kScale}, {"origin", AlignmentMode::kOrigin}};

// Units of --delta-unit, with the factor to the library's units.
const std::map<std::string, std::pair<DeltaUnit, double>> kDeltaUnits = {{"frames", {DeltaUnit::kFrames, 1.0}},
                                                                         {"m", {DeltaUnit::kMetres, 1.0}},
                                                                         {"s", {DeltaUnit::kSeconds, 1.0}},
                                                                         {"deg", {DeltaUnit::kRadians, kDegPerRad}},
                                                                         {"rad", {DeltaUnit::kRadians, 1.0}}};

// The plotted error and its unit.
struct PlottedError {
  double PoseError::*member;
  const char* unit;
  double per_si;
};
const std::map<std::string, PlottedError> kPlottedErrors = {{"translation", {&PoseError::translation_m, "mm", kMmPerM}},
                                                            {"rotation", {&PoseError::rotation_rad, "deg", kDegPerRad}},
                                                            {"full", {&PoseError::full, "", 1.0}}};

// Raw command line arguments.
struct Arguments {
  std::string metric;
  std::filesystem::path reference_file;
  std::filesystem::path estimate_file;
  std::string align = "none";
  double delta = 1.0;
  std::string delta_unit = "frames";
  bool json = false;
  std::filesystem::path plot_file;
  std::string plot_error = "translation";
  std::filesystem::path errors_file;
  EvaluationOptions options;

  bool relative() const { return metric == "rpe"; }
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

EvaluationOptions Translate(const Arguments& a) {
  EvaluationOptions options = a.options;
  options.metric = a.relative() ? ErrorMetric::kRelative : ErrorMetric::kAbsolute;
  options.align = kAlignmentModes.at(a.align);
  const auto& [unit, per_our_unit] = kDeltaUnits.at(a.delta_unit);
  options.motions.unit = unit;
  options.motions.delta = a.delta / per_our_unit;
  options.motions.Check();
  return options;
}

TrajectoryEvaluation Evaluate(const Arguments& a) {
  const EvaluationOptions options = Translate(a);
  const Trajectory reference = ReadTrajectory(a.reference_file);
  const Trajectory estimate = ReadTrajectory(a.estimate_file);
  try {
    return EvaluateTrajectory(reference, estimate, options);
  } catch (const std::invalid_argument& error) {
    throw InputError(a.estimate_file, error.what());
  }
}

// Statistics scale with the unit, a sum of squares with its square.
double InUnit(double value, const char* statistic, double per_si) {
  return value * (std::string_view(statistic) == "sse" ? per_si * per_si : per_si);
}

nlohmann::ordered_json StatisticsJson(const ErrorStatistics& statistics, double per_si = 1.0) {
  nlohmann::ordered_json json;
  for (const auto& [name, member] : kStatistics) {
    json[name] = InUnit(statistics.*member, name, per_si);
  }
  return json;
}

void PrintJson(const TrajectoryEvaluation& evaluation, const Arguments& a) {
  const Similarity3& moved = evaluation.alignment;
  nlohmann::ordered_json json = {{"metric", a.metric},
                                 {"align", a.align},
                                 {"pairs", evaluation.pairs.size()},
                                 {"reference_poses", evaluation.reference_poses},
                                 {"estimated_poses", evaluation.estimated_poses},
                                 {"translation", StatisticsJson(evaluation.translation)},
                                 {"rotation", StatisticsJson(evaluation.rotation)},
                                 {"rotation_deg", StatisticsJson(evaluation.rotation, kDegPerRad)},
                                 {"full", StatisticsJson(evaluation.full)}};
  const Eigen::Quaterniond& q = moved.rotation;
  json["alignment"] = {{"translation", {moved.translation_m.x(), moved.translation_m.y(), moved.translation_m.z()}},
                       {"quaternion_xyzw", {q.x(), q.y(), q.z(), q.w()}},
                       {"scale", moved.scale}};
  if (a.relative()) {
    json["delta"] = a.delta;
    json["delta_unit"] = a.delta_unit;
    json["all_pairs"] = a.options.motions.all_pairs;
    json["motions"] = evaluation.errors.size();
  }
  std::cout << json.dump(2) << "\n";
}

// Description of the evaluated errors, appended to the name of the metric.
std::string Conditions(const Arguments& a) {
  std::ostringstream text;
  if (a.relative()) {
    text << " over " << a.delta << " " << a.delta_unit << (a.options.motions.all_pairs ? ", all pairs" : "");
  }
  text << ", alignment " << a.align << (a.options.planar ? ", in the plane" : "");
  return text.str();
}

void PrintTable(const TrajectoryEvaluation& evaluation, const Arguments& a) {
  std::printf("%s%s: %zu pairs of %zu reference and %zu estimated poses\n", a.metric.c_str(), Conditions(a).c_str(),
              evaluation.pairs.size(), evaluation.reference_poses, evaluation.estimated_poses);
  if (a.relative()) {
    std::printf("%zu motions compared\n", evaluation.errors.size());
  }
  std::printf("%-8s %18s %18s %18s %18s\n", "", "translation [mm]", "rotation [deg]", "rotation [rad]", "full [-]");
  for (const auto& [name, member] : kStatistics) {
    std::printf("%-8s %18.4f %18.5f %18.7f %18.7f%s\n", name, InUnit(evaluation.translation.*member, name, kMmPerM),
                InUnit(evaluation.rotation.*member, name, kDegPerRad), evaluation.rotation.*member,
                evaluation.full.*member, std::string_view(name) == "sse" ? "   (squared units)" : "");
  }
  const Similarity3& moved = evaluation.alignment;
  if (a.align != "none") {
    std::printf("estimate moved by (%.6f, %.6f, %.6f) m, turned by %.6f deg, scaled by %.9f\n", moved.translation_m.x(),
                moved.translation_m.y(), moved.translation_m.z(),
                kDegPerRad * Eigen::Quaterniond::Identity().angularDistance(moved.rotation), moved.scale);
  }
  std::fflush(stdout);
}

void Plot(const TrajectoryEvaluation& evaluation, const Arguments& a) {
  const PlottedError& plotted = kPlottedErrors.at(a.plot_error);
  ErrorPlot plot;
  plot.title = a.metric + " of " + a.estimate_file.filename().string() + ", " + a.plot_error + Conditions(a);
  plot.unit = plotted.unit;
  for (const PosePair& pair : evaluation.pairs) {
    plot.reference_m.push_back(pair.reference.translation_m.head<2>());
  }
  for (std::size_t i = 0; i < evaluation.errors.size(); ++i) {
    const PosePair& pair = evaluation.pairs[evaluation.error_at[i]];
    plot.samples.push_back({ToSeconds(pair.estimate.stamp_ns), pair.estimate.translation_m.head<2>(),
                            plotted.per_si * evaluation.errors[i].*plotted.member});
  }
  // Overlapping rotations are ordered by their start.
  std::stable_sort(plot.samples.begin(), plot.samples.end(),
                   [](const ErrorSample& one, const ErrorSample& other) { return one.time_s < other.time_s; });
  WriteErrorPlot(a.plot_file, plot);
}

void WriteErrors(const TrajectoryEvaluation& evaluation, const std::filesystem::path& file) {
  std::string text = "timestamp,translation_m,rotation_rad,full\n";
  for (const PoseError& error : evaluation.errors) {
    std::array<char, 128> numbers{};
    std::snprintf(numbers.data(), numbers.size(), ",%.9g,%.9g,%.9g\n", error.translation_m, error.rotation_rad,
                  error.full);
    text += FormatSeconds(error.stamp_ns) + numbers.data();
  }
  WriteFileAtomically(file, text);
}

void Run(const Arguments& a) {
  const TrajectoryEvaluation evaluation = Evaluate(a);
  if (!a.plot_file.empty()) {
    Plot(evaluation, a);
  }
  if (!a.errors_file.empty()) {
    WriteErrors(evaluation, a.errors_file);
  }
  a.json ? PrintJson(evaluation, a) : PrintTable(evaluation, a);
}

template <typename Value>
CLI::IsMember OneOf(const std::map<std::string, Value>& choices) {
  std::vector<std::string> names;
  for (const auto& [name, value] : choices) {
    names.push_back(name);
  }
  return CLI::IsMember(names);
}

void AddMotionOptions(CLI::App* command, Arguments* a) {
  MotionOptions& motions = a->options.motions;
  command->add_option("--delta", a->delta, "rpe: length of the motions")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--delta-unit", a->delta_unit, "rpe: frames, m (of path), s, deg or rad (of turning)")
      ->check(OneOf(kDeltaUnits))
      ->capture_default_str();
  command->add_flag("--all-pairs", motions.all_pairs, "rpe: overlapping motions, from every pose");
  command
      ->add_option("--delta-tolerance", motions.relative_tolerance,
                   "rpe: how far a length may be from --delta, as a part of it; for s, and with --all-pairs")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_flag("--pairs-from-reference", a->options.motions_of_reference,
                    "rpe: measure the lengths along the reference, not the estimate");
}

}  // namespace

void AddEvaluateCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("evaluate", "Trajectory errors, with the definitions of evo.");
  const auto a = std::make_shared<Arguments>();
  command->add_option("metric", a->metric, "ape: error of the poses; rpe: error of the motions between them")
      ->required()
      ->check(CLI::IsMember({"ape", "rpe"}));
  command->add_option("reference", a->reference_file, "true trajectory (TUM, or EuRoC when .csv)")->required();
  command->add_option("estimate", a->estimate_file, "estimated trajectory")->required();
  command
      ->add_option("--align", a->align,
                   "Move the estimate onto the reference first: se2, se3 or sim3 by least squares; origin: so that the "
                   "first poses agree; scale: only scale it")
      ->check(OneOf(kAlignmentModes))
      ->capture_default_str();
  command->add_option("--max-diff", a->options.max_diff_s, "largest time difference of a pair, seconds")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--time-offset", a->options.time_offset_s, "added to the estimate's time stamps, seconds")
      ->check(CLI::Range(-kMaxOffsetS, kMaxOffsetS));
  command->add_flag("--planar", a->options.planar, "compare x, y and yaw only");
  AddMotionOptions(command, a.get());
  command->add_flag("--json", a->json, "print JSON: metres, and radians where no unit is named");
  command->add_option("--plot", a->plot_file, "draw the errors along the trajectory and over time into this PNG file");
  command->add_option("--plot-error", a->plot_error, "which errors are drawn: translation, rotation or full")
      ->check(OneOf(kPlottedErrors))
      ->capture_default_str();
  command->add_option("--errors", a->errors_file, "write every single error into this CSV file");
  command->callback([a] { Run(*a); });
}

}  // namespace floorloc
