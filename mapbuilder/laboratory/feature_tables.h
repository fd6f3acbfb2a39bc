// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/laboratory/feature_measurements.h"
#include "mapbuilder/laboratory/result_table.h"

namespace floorloc {

/// What one kind of features did on the images of a set.
struct SetScore {
  std::string set;
  DetectorKind kind = DetectorKind::kOrb;
  std::vector<ImageScore> images;
};

/// What one kind of features, about `wanted` of them, did on all sequences.
struct FollowingScore {
  DetectorKind kind = DetectorKind::kOrb;
  int wanted = 0;
  std::vector<SequenceScore> sequences;
};

/// Table 1: time per image. scores: set by set, each with the same kinds.
ResultTable TimeTable(const std::vector<SetScore>& scores);

/// Tables 2 and 3: matches with the manipulated copies, of one set's scores.
ResultTable ConditionTable(int number, const std::vector<SetScore>& scores);

/// Table 4: matches with the following frames by the number of features.
ResultTable FollowingTable(const std::vector<FollowingScore>& scores);

/// Table 5: how these matches go together with the number of features.
ResultTable CorrelationTable(const std::vector<FollowingScore>& scores);

}  // namespace floorloc
