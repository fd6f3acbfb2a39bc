// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/laboratory/feature_measurements.h"
#include "mapbuilder/laboratory/result_table.h"

namespace floorloc {

/// Scores of one feature type on the images of a set.
struct SetScore {
  std::string set;
  DetectorKind kind = DetectorKind::kOrb;
  std::vector<ImageScore> images;
};

/// Scores of one feature type, tuned to about `wanted` features, on all sequences.
struct FollowingScore {
  DetectorKind kind = DetectorKind::kOrb;
  int wanted = 0;
  std::vector<SequenceScore> sequences;
};

/// Table 1: time per image. scores: ordered by set, each with the same feature types.
ResultTable TimeTable(const std::vector<SetScore>& scores);

/// Tables 2 and 3: matches with the manipulated copies, for one set's scores.
ResultTable ConditionTable(int number, const std::vector<SetScore>& scores);

/// Table 4: matches with the following frames by the number of features.
ResultTable FollowingTable(const std::vector<FollowingScore>& scores);

/// Table 5: correlation of these matches with the number of features.
ResultTable CorrelationTable(const std::vector<FollowingScore>& scores);

}  // namespace floorloc
