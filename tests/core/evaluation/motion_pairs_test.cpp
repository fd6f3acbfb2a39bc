// SPDX-License-Identifier: Apache-2.0
#include "core/evaluation/motion_pairs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <ostream>
#include <stdexcept>

namespace floorloc {

void PrintTo(const Motion& motion, std::ostream* out) { *out << "(" << motion.from << ", " << motion.to << ")"; }

namespace {

constexpr double kPi = std::numbers::pi;
using Motions = std::vector<Motion>;

// One pose per height, a second apart.
Trajectory AtHeights(const std::vector<double>& heights_m) {
  Trajectory trajectory;
  for (const double height : heights_m) {
    const auto stamp_ns = static_cast<std::int64_t>(trajectory.size()) * 1'000'000'000;
    trajectory.push_back({stamp_ns, {0, 0, height}, Eigen::Quaterniond::Identity()});
  }
  return trajectory;
}

// One pose per angle about x.
Trajectory AtAngles(const std::vector<double>& angles_rad) {
  Trajectory trajectory = AtHeights(std::vector<double>(angles_rad.size(), 0.0));
  for (std::size_t i = 0; i < angles_rad.size(); ++i) {
    trajectory[i].rotation = Eigen::AngleAxisd(angles_rad[i], Eigen::Vector3d::UnitX());
  }
  return trajectory;
}

Trajectory AtSeconds(const std::vector<double>& times_s) {
  Trajectory trajectory;
  for (const double time : times_s) {
    trajectory.push_back(StampedPose3::FromPose2(std::llround(1e9 * time), {}));
  }
  return trajectory;
}

TEST(SelectMotions, ByFrames) {
  const Trajectory seven = AtHeights({0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(SelectMotions(seven, {.delta = 2}), (Motions{{0, 2}, {2, 4}, {4, 6}}));
  EXPECT_EQ(SelectMotions(seven, {.delta = 3}), (Motions{{0, 3}, {3, 6}}));
  EXPECT_EQ(SelectMotions(seven, {.delta = 4}), (Motions{{0, 4}}));
  EXPECT_EQ(SelectMotions(seven, {.delta = 5, .all_pairs = true}), (Motions{{0, 5}, {1, 6}}));
  EXPECT_EQ(SelectMotions(seven, {.delta = 7}), Motions());
  EXPECT_EQ(SelectMotions({}, {.delta = 1}), Motions());
}

// Poses and expected pairs from evo's tests of its own filters (test/test_filters.py).
TEST(SelectMotions, ByPathAllPairsAsPublishedForEvo) {
  const auto by_path = [](const std::vector<double>& heights, double delta, double tolerance_m) {
    return SelectMotions(
        AtHeights(heights),
        {.delta = delta, .unit = DeltaUnit::kMetres, .all_pairs = true, .relative_tolerance = tolerance_m / delta});
  };
  EXPECT_EQ(by_path({0, 0.5, 0, 1}, 1.0, 0.0), (Motions{{0, 2}, {2, 3}}));
  EXPECT_EQ(by_path({0, 0.5, 0, 1}, 2.5, 0.0), Motions());
  EXPECT_EQ(by_path({0, 0.5, 0.99, 1.0}, 1.0, 0.001), (Motions{{0, 3}}));
  EXPECT_EQ(by_path({0, 0.9, 0.99, 0.999, 0.9999, 0.99999, 0.999999, 0.9999999}, 1.0, 0.2), (Motions{{0, 7}}));
}

TEST(SelectMotions, ByAngleAsPublishedForEvo) {
  const auto by_angle = [](const std::vector<double>& angles, double delta, double tolerance_rad, bool all_pairs) {
    return SelectMotions(AtAngles(angles), {.delta = delta,
                                            .unit = DeltaUnit::kRadians,
                                            .all_pairs = all_pairs,
                                            .relative_tolerance = tolerance_rad / delta});
  };
  const std::vector<double> back_and_forth = {0, kPi, 0, kPi / 3, kPi};
  EXPECT_EQ(by_angle(back_and_forth, kPi - 0.001, 0.001, false), (Motions{{0, 1}, {1, 2}, {2, 4}}));
  EXPECT_EQ(by_angle(back_and_forth, kPi, 0.01, true), (Motions{{0, 1}, {0, 4}, {1, 2}, {2, 4}}));
  const std::vector<double> on_and_on = {0, kPi / 3, 2 * kPi / 3, kPi, kPi};
  EXPECT_EQ(by_angle(on_and_on, kPi - 0.001, 0.001, false), (Motions{{0, 3}}));
  EXPECT_EQ(by_angle(on_and_on, kPi, 0.001, true), (Motions{{0, 3}, {0, 4}}));
}

// Computed by hand: the path reaches 1 m at pose 2 (1.2 m), one more metre at pose 4 and another at pose 5.
TEST(SelectMotions, ByPathOneAfterTheOtherBeginsAtTheFirstMilestone) {
  EXPECT_EQ(SelectMotions(AtHeights({0, 0.6, 1.2, 1.9, 2.3, 3.4}), {.delta = 1.0, .unit = DeltaUnit::kMetres}),
            (Motions{{2, 4}, {4, 5}}));
}

TEST(SelectMotions, OfSeveralPosesAtOnePlaceTheFirstEndsTheMotion) {
  EXPECT_EQ(SelectMotions(AtHeights({0, 0.95, 0.95, 0.95}),
                          {.delta = 1.0, .unit = DeltaUnit::kMetres, .all_pairs = true, .relative_tolerance = 0.06}),
            (Motions{{0, 1}}));
}

TEST(SelectMotions, BySeconds) {
  const Trajectory gap = AtSeconds({0, 0.49, 0.98, 1.51, 2.04, 7.0, 7.5, 7.97});
  EXPECT_EQ(SelectMotions(gap, {.delta = 1.0, .unit = DeltaUnit::kSeconds}), (Motions{{0, 2}, {2, 4}, {5, 7}}));
  EXPECT_EQ(SelectMotions(gap, {.delta = 1.0, .unit = DeltaUnit::kSeconds, .all_pairs = true}),
            (Motions{{0, 2}, {1, 3}, {2, 4}, {5, 7}}));
}

TEST(SelectMotions, RefusesDeltasThatMeanNothing) {
  const Trajectory poses = AtHeights({0, 1});
  EXPECT_THROW(SelectMotions(poses, {.delta = 0}), std::invalid_argument);
  EXPECT_THROW(SelectMotions(poses, {.delta = 1.5}), std::invalid_argument);
  EXPECT_THROW(SelectMotions(poses, {.delta = std::numeric_limits<double>::quiet_NaN()}), std::invalid_argument);
  EXPECT_THROW(SelectMotions(poses, {.delta = 3.2, .unit = DeltaUnit::kRadians}), std::invalid_argument);
  EXPECT_THROW(SelectMotions(poses, {.relative_tolerance = -1}), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
