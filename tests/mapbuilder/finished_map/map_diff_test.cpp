// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/finished_map/map_diff.h"

#include <gtest/gtest.h>

#include "tests/core/map/map_test_support.h"

namespace floorloc {
namespace {

using testing_map::MakeContent;
using testing_map::MapContent;
using testing_map::WriteMap;

// A map of one survey called "hall", and the same extended with that survey again: its frames are 10 mm off.
class RepeatedSurveyTest : public ::testing::Test {
 protected:
  RepeatedSurveyTest() {
    MapContent content = MakeContent();
    content.info.cameras.resize(1);
    content.info.surveys_json = R"([{"folder":"hall"}])";
    content.links.clear();
    content.frames = {{1, "images/0.jpg", Pose2(0.0, 0.0, 0.0)}, {2, "images/1.jpg", Pose2(1.0, 0.0, 0.0)}};
    std::ranges::fill(content.keypoints.last_survey, std::uint16_t{0});
    WriteMap(once_, content);
    content.info.cameras.push_back(content.info.cameras.front());
    content.info.surveys_json = R"([{"folder":"hall"},{"folder":"hall"}])";
    content.frames.push_back({1, "images/0.jpg", Pose2(0.01, 0.0, 0.0), 1});
    content.frames.push_back({2, "images/1.jpg", Pose2(1.01, 0.0, 0.0), 1});
    WriteMap(twice_, content);
  }

  TemporaryFolder folder_;
  const std::filesystem::path once_ = folder_.path() / "once.floormap";
  const std::filesystem::path twice_ = folder_.path() / "twice.floormap";
};

TEST_F(RepeatedSurveyTest, EachFrameIsMatchedOnce) {
  const MapDiff diff = CompareMaps(MapDatabase(once_), MapDatabase(twice_));
  EXPECT_EQ(diff.frames_kept, 2);
  EXPECT_EQ(diff.frames_added, 2);
  EXPECT_EQ(diff.frames_removed, 0);
  EXPECT_EQ(diff.moves.max_m, 0.0) << "matched with the frame of the other survey";
}

TEST_F(RepeatedSurveyTest, EachFrameIsMatchedOnceTheOtherWayRound) {
  const MapDiff diff = CompareMaps(MapDatabase(twice_), MapDatabase(once_));
  EXPECT_EQ(diff.frames_kept, 2);
  EXPECT_EQ(diff.frames_added, 0);
  EXPECT_EQ(diff.frames_removed, 2);
  EXPECT_EQ(diff.moves.max_m, 0.0) << "matched with the frame of the other survey";
}

TEST_F(RepeatedSurveyTest, AMapWithASurveyTwiceEqualsItself) {
  const MapDiff diff = CompareMaps(MapDatabase(twice_), MapDatabase(twice_));
  EXPECT_EQ(diff.frames_kept, 4);
  EXPECT_EQ(diff.frames_added + diff.frames_removed, 0);
  EXPECT_EQ(diff.moves.max_m, 0.0);
}

}  // namespace
}  // namespace floorloc
