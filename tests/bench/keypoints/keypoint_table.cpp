// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/keypoints/keypoint_table.h"

#include <iomanip>
#include <ostream>

#include "core/evaluation/fix_score.h"

namespace floorloc {
namespace {

double SuccessPercent(const SearchTally& search) { return 100.0 * search.right / search.frames; }

void PrintRow(std::ostream& out, const KeypointTally& tally, const GroupTally& group) {
  const SearchTally& global = group.global;
  const SearchTally& guided = group.with_prior;
  const auto put = [&out](int width, int decimals, double value) {
    out << std::fixed << std::setw(width) << std::setprecision(decimals) << value;
  };
  out << std::left << std::setw(9) << ToString(tally.rule) << std::right;
  put(8, 0, tally.budget_per_m2);
  put(8, 0, static_cast<double>(tally.keypoints) / tally.area_m2);
  put(8, 0, static_cast<double>(tally.file_bytes) / 1000.0 / tally.area_m2);
  put(9, 0, Percentile(global.inliers, 0.5));
  put(9, 0, Percentile(global.inliers, 0.1));
  put(9, 1, SuccessPercent(global));
  put(9, 1, SuccessPercent(guided));
  put(7, 0, global.wrong + guided.wrong);
  put(8, 2, 1000.0 * Percentile(guided.errors_m, 0.5));
  put(10, 2, 1000.0 * Percentile(guided.errors_m, 0.99));
  out << '\n';
}

}  // namespace

void PrintTable(std::ostream& out, const std::vector<KeypointTally>& tallies, const std::vector<std::string>& groups) {
  out << "rule       budget      in      kB  inliers  inliers  success  + prior  wrong   error     error\n"
         "           per m2     map  per m2   median     10 %        %        %             mm  99 %, mm\n";
  for (const std::string& group : groups) {
    out << "-- " << group << ": " << tallies.front().groups.at(group).global.frames << " frames\n";
    for (const KeypointTally& tally : tallies) {
      PrintRow(out, tally, tally.groups.at(group));
    }
  }
}

}  // namespace floorloc
