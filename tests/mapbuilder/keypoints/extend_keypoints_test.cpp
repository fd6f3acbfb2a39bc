// SPDX-License-Identifier: Apache-2.0
// FuseKeypoints with a base map.
#include <gtest/gtest.h>

#include <algorithm>

#include "mapbuilder/keypoints/fuse_keypoints.h"
#include "tests/mapbuilder/keypoints/floor_points.h"

namespace floorloc {
namespace {

constexpr int kOldSurveys = 2;
const Pose2 kPose(0.3, 0.5, 0.4);

using Poses = std::vector<std::optional<Pose2>>;

// A map with all points of the floor, each observed by three frames.
MapKeypoints BuildMapOf(const FloorPoints& floor) {
  MapKeypoints map;
  map.keypoints = floor.points;
  map.descriptors = floor.descriptors.clone();
  map.observations.assign(map.size(), 3);
  map.distinctiveness.assign(map.size(), 255);
  map.last_survey.assign(map.size(), kOldSurveys - 1);
  return map;
}

MapKeypoints Extend(const MapKeypoints& base_map, const std::vector<BuildFrame>& frames,
                    const KeypointFusionOptions& options = {}) {
  const Poses poses(frames.size(), kPose);
  const std::vector<RectM> floors(frames.size(), kFloorInView);
  return FuseKeypoints({frames, poses, floors, &base_map, nullptr, kOldSurveys}, options);
}

// Index of the map's keypoint at this position, or -1.
int Find(const MapKeypoints& map, const Keypoint& point) {
  for (std::size_t i = 0; i < map.size(); ++i) {
    if ((map.keypoints[i].Position() - point.Position()).norm() < 1e-3) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

class ExtendKeypointsTest : public ::testing::TestWithParam<bool> {};

TEST_P(ExtendKeypointsTest, ReobservedPointsAreUpdatedAndTheRestStays) {
  FloorPoints floor(60, GetParam(), 1);
  const MapKeypoints base_map = BuildMapOf(floor);
  const MapKeypoints map = Extend(base_map, {floor.Observe(kPose, 0.0), floor.Observe(kPose, 0.0)});
  ASSERT_EQ(map.size(), base_map.size());
  for (std::size_t i = 0; i < base_map.size(); ++i) {
    const bool seen = floor.InView(i, kPose);
    EXPECT_EQ(map.observations[i], seen ? 5 : 3);
    EXPECT_EQ(map.last_survey[i], seen ? kOldSurveys : kOldSurveys - 1);
    EXPECT_NEAR(map.keypoints[i].x_m, base_map.keypoints[i].x_m, seen ? 1e-5 : 0.0);
    EXPECT_NEAR(map.keypoints[i].angle_rad, base_map.keypoints[i].angle_rad, seen ? 1e-5 : 0.0);
  }
}

TEST_P(ExtendKeypointsTest, PositionsAreAveragedByTheNumbersOfObservations) {
  FloorPoints floor(1, GetParam(), 2);
  floor.points[0].x_m = 0.5F;
  floor.points[0].y_m = 0.5F;
  const MapKeypoints base_map = BuildMapOf(floor);  // three observations
  floor.points[0].x_m += 4e-4F;
  const MapKeypoints map = Extend(base_map, {floor.Observe(kPose, 0.0)});
  ASSERT_EQ(map.size(), 1U);
  EXPECT_NEAR(map.keypoints[0].x_m, 0.5 + 1e-4, 1e-6);
}

TEST_P(ExtendKeypointsTest, WhatManyFramesMissIsRemoved) {
  FloorPoints floor(200, GetParam(), 3);
  const MapKeypoints base_map = BuildMapOf(floor);
  FloorPoints worn(100, GetParam(), 3);  // half of the points no longer exist
  worn.points.assign(floor.points.begin(), floor.points.begin() + 100);
  worn.descriptors = floor.descriptors.rowRange(0, 100);
  const MapKeypoints few = Extend(base_map, {worn.Observe(kPose, 0.0), worn.Observe(kPose, 0.0)});
  EXPECT_EQ(few.size(), base_map.size()) << "two frames do not tell";
  const MapKeypoints map = Extend(base_map, std::vector<BuildFrame>(5, worn.Observe(kPose, 0.0)));
  int gone = 0;
  for (std::size_t i = 0; i < base_map.size(); ++i) {
    const bool there = Find(map, base_map.keypoints[i]) >= 0;
    gone += there ? 0 : 1;
    EXPECT_TRUE(there || (i >= 100 && floor.InView(i, kPose)));
  }
  std::size_t worn_in_view = 0;
  for (std::size_t i = 100; i < 200; ++i) {
    worn_in_view += floor.InView(i, kPose) ? 1 : 0;
  }
  EXPECT_GE(gone, static_cast<int>(worn_in_view) * 3 / 4) << "but for those at the edge of the view";
}

// A point that the base map's frames rarely observed although in view is not removed when a few more frames miss it.
TEST_P(ExtendKeypointsTest, RarelyObservedPointsAreRemovedLater) {
  FloorPoints floor(200, GetParam(), 4);
  MapKeypoints base_map = BuildMapOf(floor);
  std::fill(base_map.observations.begin() + 100, base_map.observations.end(), std::uint16_t{2});
  FloorPoints half(100, GetParam(), 4);
  half.points.assign(floor.points.begin(), floor.points.begin() + 100);
  half.descriptors = floor.descriptors.rowRange(0, 100);
  const std::vector<BuildFrame> frames(5, half.Observe(kPose, 0.0));
  const Poses poses(5, kPose);
  const std::vector<RectM> floors(5, kFloorInView);
  const CoverageGrid twenty(Poses(20, Pose2(0.0, 0.5, 0.0)), std::vector<RectM>(20, {-1.0, 2.0, -2.0, 2.0}));
  const CoverageGrid two(Poses(2, Pose2(0.0, 0.5, 0.0)), std::vector<RectM>(2, {-1.0, 2.0, -2.0, 2.0}));
  EXPECT_EQ(FuseKeypoints({frames, poses, floors, &base_map, &twenty, kOldSurveys}, {}).size(), base_map.size());
  EXPECT_LT(FuseKeypoints({frames, poses, floors, &base_map, &two, kOldSurveys}, {}).size(), base_map.size());
}

TEST_P(ExtendKeypointsTest, NewPointsCome) {
  FloorPoints floor(100, GetParam(), 5);
  FloorPoints scratches(50, GetParam(), 6);
  const MapKeypoints base_map = BuildMapOf(floor);
  BuildFrame frame = floor.Observe(kPose, 0.0);
  const BuildFrame fresh = scratches.Observe(kPose, 0.0);
  frame.features.keypoints.insert(frame.features.keypoints.end(), fresh.features.keypoints.begin(),
                                  fresh.features.keypoints.end());
  cv::vconcat(frame.features.descriptors, fresh.features.descriptors, frame.features.descriptors);
  const MapKeypoints map = Extend(base_map, {frame, frame});
  EXPECT_EQ(map.size(), base_map.size() + fresh.features.keypoints.size());
  for (std::size_t i = 0; i < scratches.points.size(); ++i) {
    const int found = Find(map, scratches.points[i]);
    ASSERT_EQ(found >= 0, scratches.InView(i, kPose));
    if (found >= 0) {
      EXPECT_EQ(map.last_survey[static_cast<std::size_t>(found)], kOldSurveys);
      EXPECT_EQ(map.observations[static_cast<std::size_t>(found)], 2);
    }
  }
}

TEST_P(ExtendKeypointsTest, TheBudgetIsThatOfTheFloorInView) {
  FloorPoints floor(3000, GetParam(), 7);
  const MapKeypoints base_map = BuildMapOf(floor);
  KeypointFusionOptions options;
  options.pruning.max_per_m2 = 500.0;
  const BuildFrame frame = floor.Observe(kPose, 0.0);
  const MapKeypoints map = Extend(base_map, {frame, frame}, options);
  const std::size_t out_of_view = base_map.size() - frame.features.keypoints.size();
  EXPECT_NEAR(static_cast<double>(map.size()), static_cast<double>(out_of_view) + 80.0, 25.0);
}

INSTANTIATE_TEST_SUITE_P(Kinds, ExtendKeypointsTest, ::testing::Bool(),
                         [](const auto& name) { return name.param ? "binary" : "float"; });

TEST(ExtendKeypointsTest, TheDescriptorFollowsWear) {
  FloorPoints floor(1, true, 8);
  floor.points[0].x_m = 0.5F;
  floor.points[0].y_m = 0.5F;
  const MapKeypoints base_map = BuildMapOf(floor);
  floor.descriptors = floor.descriptors.clone();
  floor.descriptors.at<std::uint8_t>(0, 5) ^= 0xFF;
  const auto changed_bits = [&](int frames) {
    const MapKeypoints map =
        Extend(base_map, std::vector<BuildFrame>(static_cast<std::size_t>(frames), floor.Observe(kPose, 0)));
    return cv::norm(map.descriptors, base_map.descriptors, cv::NORM_HAMMING);
  };
  EXPECT_EQ(changed_bits(1), 0.0) << "one view may be a bad one";
  EXPECT_EQ(changed_bits(2), 8.0);
}

}  // namespace
}  // namespace floorloc
