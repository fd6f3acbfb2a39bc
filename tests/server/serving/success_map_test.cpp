// SPDX-License-Identifier: Apache-2.0
#include "server/serving/success_map.h"

#include <gtest/gtest.h>

namespace floorloc {
namespace {

MapInfo Hall(const std::string& version) {
  MapInfo info;
  info.extent = {0.0, 2.0, 0.0, 2.0};
  info.content_version = version;
  return info;
}

SuccessSample Found(double x, double y, int inliers) { return {Eigen::Vector2d(x, y), true, inliers}; }
SuccessSample Missed(double x, double y) { return {Eigen::Vector2d(x, y), false, 0}; }

class SuccessMapTest : public testing::Test {
 protected:
  void Add(const MapInfo& map, const SuccessSample& sample, double now_s) { success_.Add("hall", map, sample, now_s); }

  SuccessMap success_{SuccessOptions()};
  MapInfo map_ = Hall("v1");
};

TEST_F(SuccessMapTest, CountsBySquare) {
  Add(map_, Found(0.6, 0.1, 100), 7.0);
  Add(map_, Found(0.9, 0.4, 200), 8.0);
  Add(map_, Missed(0.55, 0.2), 9.0);
  Add(map_, Missed(1.1, 1.9), 9.0);
  Add(map_, {}, 9.0);
  Add(map_, Missed(30.0, 0.2), 9.0);  // a prior beyond the floor
  const MapSuccess hall = success_.Of("hall", "v1");
  EXPECT_EQ(hall.since_s, 7.0);
  EXPECT_EQ(hall.unplaced, 2);
  ASSERT_EQ(hall.squares.size(), 2U);
  EXPECT_EQ(hall.squares[0].x, 1);
  EXPECT_EQ(hall.squares[0].y, 0);
  EXPECT_EQ(hall.squares[0].found, 2);
  EXPECT_EQ(hall.squares[0].missed, 1);
  EXPECT_EQ(hall.squares[0].inliers, 300);
  EXPECT_EQ(hall.squares[1].y, 3);
}

TEST_F(SuccessMapTest, BeginsAnewWithAnotherVersion) {
  Add(map_, Found(0.6, 0.1, 100), 7.0);
  Add(Hall("v2"), Found(1.6, 1.1, 100), 8.0);
  EXPECT_TRUE(success_.Of("hall", "v1").squares.empty());
  ASSERT_EQ(success_.Of("hall", "v2").squares.size(), 1U);
  EXPECT_EQ(success_.Of("hall", "v2").since_s, 8.0);
  EXPECT_TRUE(success_.Of("cellar", "v2").squares.empty());
}

TEST_F(SuccessMapTest, ForgetsSlowly) {
  for (int i = 0; i < 5000; ++i) {
    Add(map_, Found(0.6, 0.1, 100), 7.0);
  }
  for (int i = 0; i < 1000; ++i) {
    Add(map_, Missed(0.6, 0.1), 7.0);
  }
  const SuccessSquare square = success_.Of("hall", "v1").squares.front();
  EXPECT_LT(square.found + square.missed, success_.options().memory_images);
  EXPECT_GT(square.missed, 2 * square.found);
  EXPECT_EQ(square.inliers, 100 * square.found);
}

TEST_F(SuccessMapTest, TellsChangesOnce) {
  Add(map_, Found(0.6, 0.1, 100), 7.0);
  Add(map_, Found(1.6, 1.1, 100), 7.0);
  EXPECT_EQ(success_.TakeChanges().at("hall").squares.size(), 2U);
  EXPECT_TRUE(success_.TakeChanges().empty());
  Add(map_, Missed(0.6, 0.1), 7.0);
  const MapSuccess changed = success_.TakeChanges().at("hall");
  ASSERT_EQ(changed.squares.size(), 1U);
  EXPECT_EQ(changed.squares[0].found, 1);
  Add(map_, {}, 7.0);
  EXPECT_EQ(success_.TakeChanges().at("hall").unplaced, 1);
}

TEST_F(SuccessMapTest, GoesOnFromWhatIsRemembered) {
  success_.Recall(
      {{"hall", {"v1", 0.5, 3.0, 4, {{1, 0, 10, 5, 1000}}}}, {"coarse", {"v1", 2.0, 3.0, 4, {{1, 0, 9, 5, 9}}}}});
  EXPECT_TRUE(success_.TakeChanges().empty());
  Add(map_, Missed(0.6, 0.1), 7.0);
  const MapSuccess hall = success_.Of("hall", "v1");
  EXPECT_EQ(hall.since_s, 3.0);
  EXPECT_EQ(hall.squares.at(0).found, 10);
  EXPECT_EQ(hall.squares.at(0).missed, 6);
  EXPECT_TRUE(success_.Of("coarse", "v1").squares.empty());
}

TEST(SampleOfTest, AnImageWithoutFloorSaysNothingOfTheMap) {
  LocalizationResult result;
  result.reason = NotLocalizedReason::kNoFloor;
  EXPECT_FALSE(SampleOf({}, result, false).has_value());
}

// By Wilson's interval: 14 of 20 may be 80 % by chance, 13 of 20 are not.
TEST(MustSurveyAgainTest, WhereSurelyTooFewAreFound) {
  const SuccessOptions options;
  const auto again = [&](std::int64_t found, std::int64_t missed) {
    return MustSurveyAgain({0, 0, found, missed, 0}, options);
  };
  EXPECT_FALSE(again(0, 19));
  EXPECT_TRUE(again(0, 20));
  EXPECT_TRUE(again(13, 7));
  EXPECT_FALSE(again(14, 6));
  EXPECT_FALSE(again(20, 0));
  EXPECT_FALSE(again(780, 220));
  EXPECT_TRUE(again(770, 230));
}

}  // namespace
}  // namespace floorloc
