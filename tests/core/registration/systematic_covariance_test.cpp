// SPDX-License-Identifier: Apache-2.0
#include "core/registration/systematic_covariance.h"

#include <gtest/gtest.h>

namespace floorloc {
namespace {

// A rotation by d about the image centre displaces a base 2 m away in +y by 2 d along x.
TEST(SystematicCovariance, TurnsAboutTheMiddleOfTheView) {
  const Pose2 pose(1.0, 5.0, 0.3);
  const Eigen::Matrix3d covariance = SystematicCovariance(pose, {1.0, 3.0}, {0.001, 0.01});
  EXPECT_NEAR(covariance(0, 0), 1e-6 + 4e-4, 1e-12);
  EXPECT_NEAR(covariance(1, 1), 1e-6, 1e-12);
  EXPECT_NEAR(covariance(2, 2), 1e-4, 1e-12);
  EXPECT_NEAR(covariance(0, 2), -2e-4, 1e-12);
  EXPECT_NEAR(covariance(1, 2), 0.0, 1e-12);
}

TEST(SystematicCovariance, MiddleIsThatOfTheInliers) {
  const std::vector<OrientedMatch> matches = {{{0, 0}, {1, 1}, 0, 0}, {{0, 0}, {9, 9}, 0, 0}, {{0, 0}, {3, 1}, 0, 0}};
  EXPECT_EQ(MeanTarget(matches, {0, 2}), Eigen::Vector2d(2, 1));
}

}  // namespace
}  // namespace floorloc
