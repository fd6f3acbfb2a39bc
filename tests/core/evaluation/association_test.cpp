// SPDX-License-Identifier: Apache-2.0
#include "core/evaluation/association.h"

#include <gtest/gtest.h>

namespace floorloc {
namespace {

// A pose at each time (milliseconds), identified by x.
Trajectory At(const std::vector<std::int64_t>& times_ms) {
  Trajectory trajectory;
  for (const std::int64_t time_ms : times_ms) {
    trajectory.push_back(StampedPose3::FromPose2(time_ms * 1'000'000, {static_cast<double>(time_ms), 0, 0}));
  }
  return trajectory;
}

std::vector<std::pair<double, double>> PairsOf(const Trajectory& reference, const Trajectory& estimate,
                                               double max_diff_s) {
  std::vector<std::pair<double, double>> pairs;
  for (const PosePair& pair : AssociateByTime(reference, estimate, max_diff_s)) {
    pairs.emplace_back(pair.reference.translation_m.x(), pair.estimate.translation_m.x());
  }
  return pairs;
}

using Pairs = std::vector<std::pair<double, double>>;

TEST(AssociateByTime, TakesTheNearest) {
  EXPECT_EQ(PairsOf(At({0, 100, 200, 300}), At({96, 207}), 0.01), (Pairs{{100, 96}, {200, 207}}));
}

TEST(AssociateByTime, WalksOverTheShorterTrajectoryWhicheverItIs) {
  EXPECT_EQ(PairsOf(At({96, 207}), At({0, 100, 200, 300}), 0.01), (Pairs{{96, 100}, {207, 200}}));
  EXPECT_EQ(PairsOf(At({100, 300}), At({101, 104}), 0.01), (Pairs{{100, 101}, {100, 104}}))
      << "equally long: over the estimate";
}

TEST(AssociateByTime, LimitIsInclusive) { EXPECT_EQ(PairsOf(At({0, 1000}), At({10, 1011}), 0.01), (Pairs{{0, 10}})); }

TEST(AssociateByTime, TheEarlierOfTwoEquallyNear) {
  EXPECT_EQ(PairsOf(At({0, 10, 20}), At({15}), 1.0), (Pairs{{10, 15}}));
}

TEST(AssociateByTime, EmptyTrajectoriesHaveNoPairs) {
  EXPECT_TRUE(PairsOf({}, At({1}), 1.0).empty());
  EXPECT_TRUE(PairsOf(At({1}), {}, 1.0).empty());
}

}  // namespace
}  // namespace floorloc
