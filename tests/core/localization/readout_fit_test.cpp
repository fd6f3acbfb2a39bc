// SPDX-License-Identifier: Apache-2.0
#include "core/localization/readout_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/option_test_support.h"

namespace floorloc {
namespace {

constexpr double kNoiseM = 3e-4;

// Matches of a view of 0.4 x 0.5 m, its rows along x: a quarter of them wrong.
ReadoutProblem Seen(double readout_s, const Eigen::Vector3d& twist, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-0.5, 0.5);
  std::normal_distribution<double> noise(0.0, kNoiseM);
  const Pose2 map_from_base(2.0, 1.0, 0.7);
  ReadoutProblem problem;
  problem.twist = twist;
  problem.resolution_m = 0.0007;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d seen(0.3 - 0.4 * any(random), 0.5 * any(random));
    const double share = (0.3 - seen.x()) / 0.4;
    const Pose2 middle_from_then = Pose2::Exp(readout_s * share * twist);
    const Eigen::Vector2d wrong =
        i % 4 == 0 ? Eigen::Vector2d(0.1 * any(random), 0.1 * any(random)) : Eigen::Vector2d(0, 0);
    const Eigen::Vector2d target =
        map_from_base * (middle_from_then * seen) + wrong + Eigen::Vector2d(noise(random), noise(random));
    const double angle = 6.0 * any(random);
    problem.matches.push_back({seen, target, angle, angle + map_from_base.yaw() + middle_from_then.yaw()});
    problem.share.push_back(share);
  }
  return problem;
}

TEST(ReadoutFitTest, FindsTheReadoutInBothDirections) {
  for (const double readout_s : {-0.033, -0.01, 0.0, 0.005, 0.02, 0.033}) {
    const auto fit = FitReadout(Seen(readout_s, {1.0, 0.1, 0.3}, 1), {});
    ASSERT_TRUE(fit) << readout_s;
    EXPECT_NEAR(fit->seconds, readout_s, 3.0 * fit->sigma_s) << readout_s;
    EXPECT_LT(fit->sigma_s, 6e-4);
  }
}

TEST(ReadoutFitTest, ItsStandardDeviationIsHonest) {
  ReadoutFitOptions options;
  options.shear_px = 0.0;
  double squares = 0.0;
  constexpr unsigned kTrials = 60;
  for (unsigned seed = 0; seed < kTrials; ++seed) {
    const auto fit = FitReadout(Seen(0.02, {1.0, 0.0, 0.0}, seed), {}, options);
    ASSERT_TRUE(fit);
    squares += std::pow((fit->seconds - 0.02) / fit->sigma_s, 2);
  }
  EXPECT_NEAR(squares / kTrials, 1.0, 0.6);
}

TEST(ReadoutFitTest, AStandingRobotShowsNone) {
  EXPECT_FALSE(FitReadout(Seen(0.02, {0.0, 0.0, 0.0}, 1), {}));
  EXPECT_FALSE(FitReadout(Seen(0.02, {0.02, 0.0, 0.0}, 1), {}));
}

TEST(ReadoutFitTest, ASlowerRobotShowsLess) {
  const auto fast = FitReadout(Seen(0.02, {1.0, 0.0, 0.0}, 1), {});
  const auto slow = FitReadout(Seen(0.02, {0.2, 0.0, 0.0}, 1), {});
  ASSERT_TRUE(fast && slow);
  EXPECT_NEAR(slow->sigma_s, 5.0 * fast->sigma_s, 2.0 * fast->sigma_s);
  EXPECT_NEAR(slow->seconds, 0.02, 3.0 * slow->sigma_s);
}

TEST(ReadoutFitTest, WrongMatchesAloneShowNone) {
  ReadoutProblem problem = Seen(0.02, {1.0, 0.0, 0.0}, 1);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> any(-0.5, 0.5);
  for (OrientedMatch& match : problem.matches) {
    match.target_m = {any(random), any(random)};
  }
  EXPECT_FALSE(FitReadout(problem, {}));
  EXPECT_FALSE(FitReadout({{}, {}, {1.0, 0.0, 0.0}, 0.0007}, {}));
}

TEST(ReadoutFitTest, EachBadOptionIsRefusedByName) {
  OptionTable<ReadoutFitOptions>()
      .Refuses("max_s", &ReadoutFitOptions::max_s, {0.0, 0.3})
      .Refuses("min_motion_m", &ReadoutFitOptions::min_motion_m, {0.0})
      .Refuses("min_inliers", &ReadoutFitOptions::min_inliers, {4})
      .Refuses("shear_px", &ReadoutFitOptions::shear_px, {-1.0})
      .Refuses("max_error_m", &ReadoutFitOptions::max_error_m, {0.0});
}

}  // namespace
}  // namespace floorloc
