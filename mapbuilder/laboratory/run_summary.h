// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/evaluation/fix_score.h"
#include "mapbuilder/laboratory/experiment.h"
#include "mapbuilder/laboratory/result_table.h"

namespace floorloc {

/// Statistics of a combination: means over the frames.
struct RunSummary {
  Combination combination;
  std::string method;
  std::string failure_reason;
  std::string bag;  ///< empty: all bags together
  int map_keypoints = 0;
  double keypoints = 0.0;
  double matches = 0.0;
  double inliers = 0.0;
  double repeatability = 0.0;
  double right_share = 0.0;  ///< of the matches that passed the filter; NaN without any
  int calculated = 0;        ///< frames with a pose, before the jump filter
  Score score;               ///< of the accepted poses
  StageMs ms;

  /// "sift/orb flann ratio+ransac", or the method's name.
  std::string Name() const;
  double SuccessPercent() const;
};

/// bag: restricts the summary to its frames.
RunSummary SummarizeRun(const CombinationRun& run, const std::vector<FrameBag>& bags, const Tolerance& tolerance,
                        std::optional<int> bag = std::nullopt);

/// Columns of the comparison: keypoints, matches, inliers, success, accuracy, precision and times.
ResultTable MakeComparisonTable(const std::vector<RunSummary>& summaries);

/// The four leading text columns: detector, descriptor, matcher, filter.
std::vector<TableColumn> CombinationColumns();
std::vector<TableCell> CombinationCells(const RunSummary& summary);

}  // namespace floorloc
