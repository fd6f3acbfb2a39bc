// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/calibration/frame_offset.h"

#include <gtest/gtest.h>

#include <random>

namespace floorloc {
namespace {

std::vector<PoseAndTruth> PosesWith(const FrameOffset& offset, double noise_m) {
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> place(-2.0, 2.0), heading(-3.1, 3.1);
  std::normal_distribution<double> noise(0.0, noise_m);
  std::vector<PoseAndTruth> poses;
  for (int i = 0; i < 40; ++i) {
    const Pose2 pose(place(rng), place(rng), heading(rng));
    const Pose2 truth = offset.Apply(pose);
    poses.push_back({pose, {truth.x() + noise(rng), truth.y() + noise(rng), truth.yaw()}});
  }
  return poses;
}

TEST(FrameOffsetTest, RecoversScaleMapAndBase) {
  const FrameOffset truth{1.004, {3.0, -1.0, 2.8}, {0.002, -0.001, 0.0}};
  const FrameOffset found = FitFrameOffset(PosesWith(truth, 0.0));
  EXPECT_NEAR(found.scale, truth.scale, 1e-6);
  EXPECT_NEAR(found.base_from_camera_base.x(), 0.002, 1e-5);
  for (const PoseAndTruth& pose : PosesWith(truth, 0.0)) {
    EXPECT_LT((found.Apply(pose.map_from_base).translation() - pose.truth_from_base.translation()).norm(), 1e-5);
  }
}

TEST(FrameOffsetTest, BaseOffsetIgnoresOutliers) {
  const FrameOffset truth{1.0, {1.0, 0.5, -0.4}, {0.003, 0.001, 0.01}};
  std::vector<PoseAndTruth> poses = PosesWith(truth, 1e-5);
  poses.front().map_from_base = Pose2(50.0, 0.0, 1.0);
  const FrameOffset found = FitBaseOffset(poses, {1.0, truth.truth_from_map, {}});
  EXPECT_NEAR(found.base_from_camera_base.x(), 0.003, 1e-4);
  EXPECT_NEAR(found.base_from_camera_base.yaw(), 0.01, 1e-4);
}

TEST(FrameOffsetTest, TwoPosesAreTooFew) { EXPECT_THROW(FitFrameOffset({{}, {}}), std::invalid_argument); }

}  // namespace
}  // namespace floorloc
