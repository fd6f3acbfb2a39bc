// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/keypoints/fuse_keypoints.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "mapbuilder/coverage/coverage.h"
#include "tests/mapbuilder/keypoints/floor_points.h"

namespace floorloc {
namespace {

MapKeypoints Fuse(const std::vector<BuildFrame>& frames, const std::vector<std::optional<Pose2>>& poses,
                  const KeypointFusionOptions& options = {}) {
  const std::vector<RectM> floors(frames.size(), kFloorInView);
  return FuseKeypoints({frames, poses, floors}, options);
}

class FuseKeypointsTest : public ::testing::TestWithParam<bool> {};

TEST_P(FuseKeypointsTest, ViewsOfOnePointBecomeOnePoint) {
  FloorPoints floor(300, GetParam(), 1);
  const std::vector<std::optional<Pose2>> poses = {Pose2(0.2, 0.5, 0.0), Pose2(0.5, 0.3, 1.5), Pose2(0.7, 0.7, -2.8)};
  std::vector<BuildFrame> frames;
  std::vector<int> found(floor.points.size(), 0);
  for (const auto& pose : poses) {
    frames.push_back(floor.Observe(*pose, 1e-4));
    for (std::size_t i = 0; i < floor.points.size(); ++i) {
      found[i] += floor.InView(i, *pose) ? 1 : 0;
    }
  }
  KeypointFusionOptions all;
  all.min_coverage = 100;
  const MapKeypoints map = Fuse(frames, poses, all);
  EXPECT_EQ(map.size(),
            static_cast<std::size_t>(std::count_if(found.begin(), found.end(), [](int n) { return n > 0; })));
  for (std::size_t k = 0; k < map.size(); ++k) {
    const auto nearest = std::min_element(floor.points.begin(), floor.points.end(), [&](const auto& a, const auto& b) {
      const Eigen::Vector2d p = map.keypoints[k].Position();
      return (a.Position() - p).norm() < (b.Position() - p).norm();
    });
    const auto i = nearest - floor.points.begin();
    EXPECT_LT((nearest->Position() - map.keypoints[k].Position()).norm(), 5e-4);
    EXPECT_LT(std::abs(WrapAngle(nearest->angle_rad - map.keypoints[k].angle_rad)), 1e-3);
    EXPECT_EQ(map.observations[k], found[static_cast<std::size_t>(i)]);
    EXPECT_LT(
        cv::norm(map.descriptors.row(static_cast<int>(k)), floor.descriptors.row(static_cast<int>(i)), cv::NORM_INF),
        1e-3);
  }
}

TEST_P(FuseKeypointsTest, ManyViewsAverageTheNoise) {
  FloorPoints floor(100, GetParam(), 2);
  std::vector<BuildFrame> frames;
  std::vector<std::optional<Pose2>> poses;
  for (int i = 0; i < 25; ++i) {
    poses.emplace_back(Pose2(0.3, 0.5, 0.0));
    frames.push_back(floor.Observe(*poses.back(), 2e-4));
  }
  const MapKeypoints map = Fuse(frames, poses);
  ASSERT_GT(map.size(), 5U);
  for (std::size_t k = 0; k < map.size(); ++k) {
    EXPECT_GE(map.observations[k], 24);
    double nearest_m = 1.0;
    for (const Keypoint& point : floor.points) {
      nearest_m = std::min(nearest_m, (point.Position() - map.keypoints[k].Position()).norm());
    }
    EXPECT_LT(nearest_m, 2e-4);
  }
}

TEST_P(FuseKeypointsTest, WhatOneOfManyFramesSawIsDropped) {
  FloorPoints floor(100, GetParam(), 3);
  FloorPoints ghosts(50, GetParam(), 4);
  const Pose2 pose(0.3, 0.5, 0.0);
  std::vector<BuildFrame> frames = {floor.Observe(pose, 0.0), floor.Observe(pose, 0.0), floor.Observe(pose, 0.0)};
  const std::size_t real = frames[0].features.keypoints.size();
  const BuildFrame dirt = ghosts.Observe(pose, 0.0);
  for (std::size_t i = 0; i < dirt.features.keypoints.size(); ++i) {
    frames[1].features.keypoints.push_back(dirt.features.keypoints[i]);
    frames[1].features.descriptors.push_back(dirt.features.descriptors.row(static_cast<int>(i)));
  }
  EXPECT_EQ(Fuse(frames, {pose, pose, pose}).size(), real);
  EXPECT_EQ(Fuse({frames[1]}, {pose}).size(), frames[1].features.keypoints.size()) << "one frame alone can't confirm";
}

TEST_P(FuseKeypointsTest, TheBudgetHolds) {
  FloorPoints floor(5000, GetParam(), 5);
  const Pose2 pose(0.3, 0.5, 0.0);
  KeypointFusionOptions options;
  options.pruning.max_per_m2 = 1000.0;
  const MapKeypoints map = Fuse({floor.Observe(pose, 0.0)}, {pose}, options);
  EXPECT_NEAR(static_cast<double>(map.size()), 160.0, 10.0);  // 0.16 m2
}

TEST_P(FuseKeypointsTest, DroppedFramesGiveNothing) {
  FloorPoints floor(300, GetParam(), 6);
  const Pose2 pose(0.3, 0.5, 0.0);
  EXPECT_EQ(Fuse({floor.Observe(pose, 0.0)}, {std::nullopt}).size(), 0U);
}

INSTANTIATE_TEST_SUITE_P(Kinds, FuseKeypointsTest, ::testing::Bool(),
                         [](const auto& name) { return name.param ? "binary" : "float"; });

TEST(FuseKeypointsTest, BitsAreDecidedByTheMajority) {
  FloorPoints floor(1, true, 7);
  const Pose2 pose(floor.points[0].x_m - 0.2, floor.points[0].y_m, 0.0);
  std::vector<BuildFrame> frames(3, floor.Observe(pose, 0.0));
  for (std::size_t i = 0; i < 3; ++i) {
    frames[i].features.descriptors = frames[i].features.descriptors.clone();
    frames[i].features.descriptors.at<std::uint8_t>(0, static_cast<int>(i)) ^= 0x11;  // each has different bit errors
  }
  const MapKeypoints map = Fuse(frames, {pose, pose, pose});
  ASSERT_EQ(map.size(), 1U);
  EXPECT_EQ(cv::norm(map.descriptors, floor.descriptors, cv::NORM_HAMMING), 0.0);
}

TEST(CoverageTest, MeasuresTheFloorThatFramesSee) {
  const std::vector<std::optional<Pose2>> poses = {Pose2(0.0, 0.0, 0.0), Pose2(0.2, 0.0, 0.0), std::nullopt,
                                                   Pose2(-3.0, 1.0, 0.7)};
  const CoverageGrid grid(poses, std::vector<RectM>(poses.size(), kFloorInView));
  EXPECT_NEAR(grid.AreaM2(), 0.24 + 0.16, 0.02);
  EXPECT_EQ(grid.CountAt({0.1, 0.0}), 1);
  EXPECT_EQ(grid.CountAt({0.3, 0.0}), 2);
  EXPECT_EQ(grid.CountAt({0.7, 0.0}), 0);
  EXPECT_EQ(grid.CountAt(Pose2(-3.0, 1.0, 0.7) * Eigen::Vector2d(0.2, 0.0)), 1);
  EXPECT_NEAR(grid.Extent().x_max, 0.6, 1e-9);
  EXPECT_NEAR(grid.Extent().y_min, -0.2, 1e-9);
}

TEST(CoverageTest, NothingCoversNothing) {
  const CoverageGrid grid({std::nullopt}, {kFloorInView});
  EXPECT_EQ(grid.AreaM2(), 0.0);
  EXPECT_EQ(grid.Extent().width_m(), 0.0);
}

}  // namespace
}  // namespace floorloc
