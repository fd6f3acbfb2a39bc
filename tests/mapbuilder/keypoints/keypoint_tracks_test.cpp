// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/keypoints/keypoint_tracks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "tests/mapbuilder/keypoints/floor_points.h"

namespace floorloc {
namespace {

using Poses = std::vector<std::optional<Pose2>>;

// Index of the floor's point that a frame's keypoint shows, by its descriptor.
int PointOf(const FloorPoints& floor, const BuildFrame& frame, int keypoint) {
  for (int i = 0; i < floor.descriptors.rows; ++i) {
    if (cv::norm(floor.descriptors.row(i), frame.features.descriptors.row(keypoint), cv::NORM_INF) == 0.0) {
      return i;
    }
  }
  return -1;
}

class KeypointTracksTest : public ::testing::TestWithParam<bool> {};

TEST_P(KeypointTracksTest, EveryViewOfAPointIsInItsTrack) {
  FloorPoints floor(300, GetParam(), 1);
  const Poses poses = {Pose2(0.2, 0.5, 0.0), std::nullopt, Pose2(0.5, 0.3, 1.5), Pose2(0.7, 0.7, -2.8)};
  std::vector<BuildFrame> frames;
  for (const auto& pose : poses) {
    frames.push_back(floor.Observe(pose.value_or(Pose2(0.3, 0.5, 0.0)), 1e-4));
  }
  const std::vector<KeypointTrack> tracks = FindTracks(frames, poses, TrackOptions());
  std::map<int, int> track_of_point;
  std::set<std::pair<int, int>> views;
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    for (const auto& [frame, keypoint] : tracks[t].views) {
      EXPECT_TRUE(views.insert({frame, keypoint}).second);
      const int point = PointOf(floor, frames[static_cast<std::size_t>(frame)], keypoint);
      EXPECT_EQ(track_of_point.try_emplace(point, t).first->second, static_cast<int>(t));
      EXPECT_LT((floor.points[static_cast<std::size_t>(point)].Position() - tracks[t].position_m).norm(), 5e-4);
    }
    EXPECT_TRUE(std::is_sorted(tracks[t].views.begin(), tracks[t].views.end()));
  }
  std::size_t keypoints = 0;
  for (const std::size_t placed : {0U, 2U, 3U}) {
    keypoints += frames[placed].features.keypoints.size();
  }
  EXPECT_EQ(views.size(), keypoints);
  EXPECT_EQ(track_of_point.size(), tracks.size());
}

TEST_P(KeypointTracksTest, DescriptorsMustAgree) {
  FloorPoints floor(1, GetParam(), 2);
  FloorPoints other(1, GetParam(), 3);
  other.points = floor.points;  // a different floor texture at the same place
  const Pose2 pose(floor.points[0].x_m - 0.2, floor.points[0].y_m, 0.0);
  EXPECT_EQ(FindTracks({floor.Observe(pose, 0.0), other.Observe(pose, 0.0)}, {pose, pose}, {}).size(), 2U);
  EXPECT_EQ(FindTracks({floor.Observe(pose, 0.0), floor.Observe(pose, 0.0)}, {pose, pose}, {}).size(), 1U);
}

TEST_P(KeypointTracksTest, FewViewsAreLeftOutOnDemand) {
  FloorPoints floor(200, GetParam(), 4);
  const Poses poses = {Pose2(0.2, 0.5, 0.0), Pose2(0.4, 0.5, 0.0)};
  const std::vector<BuildFrame> frames = {floor.Observe(*poses[0], 0.0), floor.Observe(*poses[1], 0.0)};
  TrackOptions options;
  options.min_views = 2;
  const std::vector<KeypointTrack> tracks = FindTracks(frames, poses, options);
  std::size_t visible_twice = 0;
  for (std::size_t i = 0; i < floor.points.size(); ++i) {
    visible_twice += floor.InView(i, *poses[0]) && floor.InView(i, *poses[1]) ? 1 : 0;
  }
  ASSERT_GT(visible_twice, 5U);
  EXPECT_EQ(tracks.size(), visible_twice);
  for (const KeypointTrack& track : tracks) {
    EXPECT_EQ(track.views.size(), 2U);
  }
}

TEST_P(KeypointTracksTest, BaseMapPointsAreJoined) {
  FloorPoints floor(200, GetParam(), 5);
  const Pose2 pose(0.3, 0.5, 0.4);
  MapKeypoints base_map;
  base_map.keypoints = floor.points;
  base_map.observations.assign(200, 3);
  base_map.descriptors = floor.descriptors;
  const BuildFrame frame = floor.Observe(pose, 1e-4);
  const std::vector<KeypointTrack> tracks = FindTracks({frame}, {pose}, {}, base_map);
  ASSERT_EQ(tracks.size(), base_map.size()) << "no new ones";
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    EXPECT_EQ(tracks[i].views.size(), floor.InView(i, pose) ? 1U : 0U);
    EXPECT_LT((tracks[i].position_m - floor.points[i].Position()).norm(), 2e-4);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, KeypointTracksTest, ::testing::Bool(),
                         [](const auto& name) { return name.param ? "binary" : "float"; });

// A frame has two similar keypoints at one place with two tracks: each joins its own track, in any order of the
// keypoints.
TEST(KeypointTracksTest, TheMostSimilarViewJoins) {
  FloorPoints floor(1, true, 6);
  const Pose2 pose(floor.points[0].x_m - 0.2, floor.points[0].y_m, 0.0);
  const BuildFrame one = floor.Observe(pose, 0.0);
  BuildFrame duplicate = floor.Observe(pose, 0.0);
  duplicate.features.descriptors = duplicate.features.descriptors.clone();
  auto* const bytes = duplicate.features.descriptors.ptr<std::uint8_t>(0);
  for (const int i : {0, 1}) {
    bytes[i] = static_cast<std::uint8_t>(~bytes[i]);  // 16 bits
  }
  BuildFrame both = one;
  both.features.keypoints.push_back(duplicate.features.keypoints[0]);
  cv::vconcat(one.features.descriptors, duplicate.features.descriptors, both.features.descriptors);
  BuildFrame swapped = both;
  swapped.features.descriptors = cv::Mat();  // separate memory
  cv::vconcat(duplicate.features.descriptors, one.features.descriptors, swapped.features.descriptors);
  const std::vector<KeypointTrack> tracks = FindTracks({both, swapped}, {pose, pose}, {});
  ASSERT_EQ(tracks.size(), 2U);
  EXPECT_EQ(tracks[0].views, (std::vector<std::pair<int, int>>{{0, 0}, {1, 1}}));
  EXPECT_EQ(tracks[1].views, (std::vector<std::pair<int, int>>{{0, 1}, {1, 0}}));
}

}  // namespace
}  // namespace floorloc
