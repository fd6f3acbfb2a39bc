// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/common/extractor_tally.h"

#include <cmath>
#include <iomanip>
#include <numbers>
#include <ostream>
#include <sstream>

namespace floorloc {
namespace {

constexpr int kNameWidth = 16;

struct Cell {
  const char* head;
  const char* unit;
  int width;
};

constexpr Cell kCells[] = {{"keypoints", "per frame", 11},
                           {"extract", "ms", 9},
                           {"map kp", "per m2", 8},
                           {"bytes", "per kp", 8},
                           {"inliers", "median", 9},
                           {"inliers", "10 %", 9},
                           {"success", "%", 9},
                           {"+ prior", "%", 9},
                           {"wrong", "", 7},
                           {"error", "mm", 7},
                           {"error", "99 %, mm", 10},
                           {"heading", "deg", 9}};

// "-" for NaN: no samples.
std::string Number(double value, int decimals) {
  if (std::isnan(value)) {
    return "-";
  }
  std::ostringstream text;
  text << std::fixed << std::setprecision(decimals) << value;
  return text.str();
}

void PrintCells(std::ostream& out, const std::string& name, const std::vector<std::string>& cells) {
  out << std::left << std::setw(kNameWidth) << name << std::right;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    out << std::setw(kCells[i].width) << cells[i];
  }
  out << '\n';
}

void PrintHead(std::ostream& out) {
  std::vector<std::string> heads, units;
  for (const Cell& cell : kCells) {
    heads.emplace_back(cell.head);
    units.emplace_back(cell.unit);
  }
  PrintCells(out, "extractor", heads);
  PrintCells(out, "", units);
}

std::string SuccessPercent(const SearchTally& search) { return Number(100.0 * search.right / search.frames, 1); }

void PrintRow(std::ostream& out, const ExtractorTally& tally, const GroupTally& group) {
  const SearchTally& global = group.global;
  const SearchTally& guided = group.with_prior;
  PrintCells(
      out, tally.name,
      {Number(Mean(group.keypoints), 0), Number(Percentile(group.extract_ms, 0.5), 1),
       Number(static_cast<double>(tally.map_keypoints) / tally.map_area_m2, 0), std::to_string(tally.keypoint_bytes),
       Number(Percentile(global.inliers, 0.5), 0), Number(Percentile(global.inliers, 0.1), 0), SuccessPercent(global),
       SuccessPercent(guided), std::to_string(global.wrong + guided.wrong),
       Number(1000.0 * Percentile(guided.errors_m, 0.5), 2), Number(1000.0 * Percentile(guided.errors_m, 0.99), 2),
       Number(Percentile(guided.errors_rad, 0.5) * 180.0 / std::numbers::pi, 3)});
}

}  // namespace

void SearchTally::Add(const LocalizationResult& result, const Pose2& true_map_from_base) {
  const Pose2 error = true_map_from_base.Between(result.map_from_base);
  const double error_m = error.translation().norm();
  const double error_rad = std::abs(error.yaw());
  const Tolerance tolerance;
  const bool near = error_m <= tolerance.position_m && error_rad <= tolerance.yaw_rad;
  const bool accepted = result.status == LocalizationStatus::kLocalized;
  ++frames;
  inliers.push_back(near ? result.inliers : 0.0);
  found.push_back(accepted && near);
  if (accepted && near) {
    ++right;
    errors_m.push_back(error_m);
    errors_rad.push_back(error_rad);
  } else if (accepted) {
    ++wrong;
  }
}

void PrintTable(std::ostream& out, const std::vector<ExtractorTally>& tallies, const std::vector<std::string>& groups) {
  PrintHead(out);
  for (const std::string& group : groups) {
    out << "-- " << group << ": " << tallies.front().groups.at(group).global.frames << " frames\n";
    for (const ExtractorTally& tally : tallies) {
      PrintRow(out, tally, tally.groups.at(group));
    }
  }
}

}  // namespace floorloc
