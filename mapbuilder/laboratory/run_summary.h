// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/evaluation/fix_score.h"
#include "mapbuilder/laboratory/experiment.h"
#include "mapbuilder/laboratory/result_table.h"

namespace floorloc {

/// A combination's outcomes in numbers: means over the frames.
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

/// bag: only the frames of that one.
RunSummary SummarizeRun(const CombinationRun& run, const std::vector<FrameBag>& bags, const Tolerance& tolerance,
                        std::optional<int> bag = std::nullopt);

/// The comparison's columns: keypoints, matches, inliers, success, accuracy, precision and times.
ResultTable MakeComparisonTable(const std::vector<RunSummary>& summaries);

/// The four words that begin a row: detector, descriptor, matcher, filter.
std::vector<TableColumn> CombinationColumns();
std::vector<TableCell> CombinationCells(const RunSummary& summary);

}  // namespace floorloc
