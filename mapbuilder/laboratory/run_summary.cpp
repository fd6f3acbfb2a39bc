// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/run_summary.h"

#include <numbers>

namespace floorloc {
namespace {

constexpr double kMmPerM = 1e3;
constexpr double kDegPerRad = 180.0 / std::numbers::pi;

void Divide(RunSummary* summary, double frames) {
  for (double* sum : {&summary->keypoints, &summary->matches, &summary->inliers, &summary->repeatability,
                      &summary->ms.detect, &summary->ms.describe, &summary->ms.match, &summary->ms.registration}) {
    *sum /= frames;
  }
}

void AddOutcome(const TestFrameOutcome& outcome, RunSummary* summary) {
  summary->keypoints += outcome.keypoints;
  summary->matches += outcome.matches;
  summary->inliers += outcome.inliers;
  summary->repeatability += outcome.repeatability;
  summary->right_share += outcome.right_matches;  // count; divided below
  summary->calculated += outcome.map_from_base ? 1 : 0;
  summary->ms.detect += outcome.ms.detect;
  summary->ms.describe += outcome.ms.describe;
  summary->ms.match += outcome.ms.match;
  summary->ms.registration += outcome.ms.registration;
}

}  // namespace

std::string RunSummary::Name() const {
  if (!method.empty()) {
    return method;
  }
  return std::string(ToString(combination.detector)) + "/" + ToString(combination.descriptor) + " " +
         ToString(combination.matcher) + " " + FilterName(combination);
}

double RunSummary::SuccessPercent() const { return score.frames > 0 ? 100.0 * score.right / score.frames : 0.0; }

RunSummary SummarizeRun(const CombinationRun& run, const std::vector<FrameBag>& bags, const Tolerance& tolerance,
                        std::optional<int> bag) {
  RunSummary summary;
  summary.combination = run.combination;
  summary.method = run.method;
  summary.failure_reason = run.failure_reason;
  summary.map_keypoints = run.map_keypoints;
  summary.bag = bag ? bags[static_cast<std::size_t>(*bag)].name : "";
  std::vector<Fix> fixes;
  std::vector<Pose2> truth;
  for (const TestFrameOutcome& outcome : run.outcomes) {
    if (bag && outcome.bag != *bag) {
      continue;
    }
    AddOutcome(outcome, &summary);
    fixes.push_back({outcome.accepted ? outcome.map_from_base : std::nullopt, outcome.ms.total()});
    truth.push_back(
        bags[static_cast<std::size_t>(outcome.bag)].frames[static_cast<std::size_t>(outcome.frame)].truth_from_base);
  }
  summary.right_share /= summary.matches;
  if (!fixes.empty()) {
    Divide(&summary, static_cast<double>(fixes.size()));
    summary.score = ComputeScore(fixes, truth, Pose2(), tolerance);
  }
  return summary;
}

std::vector<TableColumn> CombinationColumns() {
  return {{"detector", "detector"}, {"descriptor", "descriptor"}, {"matcher", "matcher"}, {"filter", "filter"}};
}

std::vector<TableCell> CombinationCells(const RunSummary& s) {
  const auto word = [](const std::string& text) { return TableCell(text); };
  if (!s.method.empty()) {
    return {word(s.method), {}, {}, {}};
  }
  const std::string detector = ToString(s.combination.detector);
  const std::string descriptor = ToString(s.combination.descriptor);
  if (!s.failure_reason.empty()) {
    return {word(detector), word(descriptor), {}, {}};
  }
  return {word(detector), word(descriptor), word(ToString(s.combination.matcher)), word(FilterName(s.combination))};
}

ResultTable MakeComparisonTable(const std::vector<RunSummary>& summaries) {
  ResultTable table;
  table.columns = CombinationColumns();
  for (const TableColumn& column : std::vector<TableColumn>{{"map_keypoints", "map kp", 0},
                                                            {"frame_keypoints", "frame kp", 0},
                                                            {"repeatability_percent", "repeat %", 1},
                                                            {"matches", "matches", 1},
                                                            {"right_percent", "right %", 1},
                                                            {"inliers", "inliers", 1},
                                                            {"localized_percent", "localized %", 1},
                                                            {"success_percent", "success %", 1},
                                                            {"position_mean_mm", "pos mean mm", 2},
                                                            {"position_median_mm", "median mm", 2},
                                                            {"heading_mean_deg", "yaw mean deg", 3},
                                                            {"heading_median_deg", "median deg", 3},
                                                            {"precision_mm", "spread mm", 2},
                                                            {"precision_deg", "spread deg", 3},
                                                            {"detect_ms", "detect ms", 2},
                                                            {"describe_ms", "describe ms", 2},
                                                            {"match_ms", "match ms", 2},
                                                            {"register_ms", "register ms", 2},
                                                            {"total_ms", "total ms", 2},
                                                            {"not_possible", "not possible", 0}}) {
    table.columns.push_back(column);
  }
  for (const RunSummary& s : summaries) {
    std::vector<TableCell> row = CombinationCells(s);
    if (!s.failure_reason.empty()) {
      row.resize(table.columns.size() - 1);
      row.emplace_back(s.failure_reason);
    } else {
      const bool points = s.method.empty();  // other methods have no keypoints
      const auto count = [&](double value) { return points ? NumberCell(value) : TableCell(); };
      const Score& score = s.score;
      for (const TableCell& cell :
           {count(s.map_keypoints), count(s.keypoints), count(100.0 * s.repeatability), count(s.matches),
            count(100.0 * s.right_share), count(s.inliers), NumberCell(100.0 * score.localized / score.frames),
            NumberCell(s.SuccessPercent()), NumberCell(kMmPerM * score.position_mean_m),
            NumberCell(kMmPerM * score.position_median_m), NumberCell(kDegPerRad * score.yaw_mean_rad),
            NumberCell(kDegPerRad * score.yaw_median_rad), NumberCell(kMmPerM * score.precision.position_m()),
            NumberCell(kDegPerRad * score.precision.yaw_rad), count(s.ms.detect), count(s.ms.describe),
            NumberCell(s.ms.match), count(s.ms.registration), NumberCell(s.ms.total())}) {
        row.push_back(cell);
      }
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace floorloc
