// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/keypoints/distinctiveness.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/mapbuilder/keypoints/floor_points.h"

namespace floorloc {
namespace {

struct Case {
  bool binary = true;
  int count = 0;  ///< few keypoints are searched by brute force, many by an index
};

class DistinctivenessTest : public ::testing::TestWithParam<Case> {};

TEST_P(DistinctivenessTest, DuplicatesElsewhereCountNearbyOnesDoNot) {
  FloorPoints floor(GetParam().count, GetParam().binary, 1);
  floor.points[0].x_m = floor.points[1].x_m = 0.2F;
  floor.points[0].y_m = floor.points[1].y_m = 0.2F;
  floor.descriptors.row(0).copyTo(floor.descriptors.row(1));  // at the same place
  floor.points[2].x_m = 0.2F;
  floor.points[3].x_m = 0.7F;
  floor.descriptors.row(2).copyTo(floor.descriptors.row(3));
  const auto measured = MeasureDistinctiveness(floor.points, floor.descriptors, {});
  ASSERT_EQ(measured.size(), floor.points.size());
  EXPECT_GT(measured[0], 100);
  EXPECT_GT(measured[1], 100);
  EXPECT_EQ(measured[2], 0);
  EXPECT_EQ(measured[3], 0);
  EXPECT_GT(std::accumulate(measured.begin(), measured.end(), 0.0) / static_cast<double>(measured.size()), 120.0);
}

TEST_P(DistinctivenessTest, ThreadsDoNotMatter) {
  const FloorPoints floor(GetParam().count, GetParam().binary, 2);
  EXPECT_EQ(MeasureDistinctiveness(floor.points, floor.descriptors, {.run = {.threads = 1}}),
            MeasureDistinctiveness(floor.points, floor.descriptors, {.run = {.threads = 3}}));
}

INSTANTIATE_TEST_SUITE_P(Kinds, DistinctivenessTest,
                         ::testing::Values(Case{true, 500}, Case{true, 5000}, Case{false, 500}, Case{false, 3000}),
                         [](const auto& c) {
                           return (c.param.binary ? "binary" : "float") + std::to_string(c.param.count);
                         });

TEST(DistinctivenessTest, NearDuplicatesAreInBetween) {
  FloorPoints floor(500, true, 3);
  floor.points[0].x_m = 0.2F;
  floor.points[1].x_m = 0.7F;
  floor.descriptors.row(0).copyTo(floor.descriptors.row(1));
  for (int byte = 0; byte < 4; ++byte) {
    floor.descriptors.at<std::uint8_t>(1, byte) ^= 0xFF;  // 32 of 256 bits; unrelated descriptors differ by 128
  }
  EXPECT_NEAR(MeasureDistinctiveness(floor.points, floor.descriptors, {})[0], 64, 2);
}

TEST(DistinctivenessTest, OneAloneIsUnique) {
  const FloorPoints floor(1, true, 4);
  EXPECT_EQ(MeasureDistinctiveness(floor.points, floor.descriptors, {}), std::vector<std::uint8_t>{255});
  EXPECT_TRUE(MeasureDistinctiveness({}, cv::Mat(), {}).empty());
}

}  // namespace
}  // namespace floorloc
