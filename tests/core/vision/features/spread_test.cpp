// SPDX-License-Identifier: Apache-2.0
#include "core/vision/features/spread.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace floorloc {
namespace {

constexpr int kCellPx = 10;

std::vector<cv::KeyPoint> RandomKeypoints(int count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(0.0F, 100.0F);
  std::vector<cv::KeyPoint> keypoints;
  for (int i = 0; i < count; ++i) {
    const float x = place(random);
    const float y = place(random);
    keypoints.emplace_back(x, y, 7.0F, 0.0F, place(random));
  }
  return keypoints;
}

int CellOf(const cv::KeyPoint& k) {
  return static_cast<int>(k.pt.y) / kCellPx * 1000 + static_cast<int>(k.pt.x) / kCellPx;
}

TEST(SpreadTest, TakesTheStrongestOfEveryCellFirst) {
  const auto keypoints = RandomKeypoints(2000, 1);
  const std::vector<int> picked = SpreadEvenly(keypoints, kCellPx, 100);  // the number of cells
  ASSERT_EQ(picked.size(), 100U);
  std::set<int> cells;
  for (const int i : picked) {
    const cv::KeyPoint& chosen = keypoints[static_cast<std::size_t>(i)];
    EXPECT_TRUE(cells.insert(CellOf(chosen)).second) << "two of one cell while another has none";
    for (const cv::KeyPoint& other : keypoints) {
      EXPECT_TRUE(CellOf(other) != CellOf(chosen) || other.response <= chosen.response);
    }
  }
}

TEST(SpreadTest, OneStrongCellDoesNotTakeAll) {
  auto keypoints = RandomKeypoints(400, 2);
  for (int i = 0; i < 300; ++i) {
    keypoints.emplace_back(5.0F, 5.0F, 7.0F, 0.0F, 1000.0F);
  }
  int in_strong_cell = 0;
  for (const int i : SpreadEvenly(keypoints, kCellPx, 200)) {
    in_strong_cell += CellOf(keypoints[static_cast<std::size_t>(i)]) == 0 ? 1 : 0;
  }
  EXPECT_LE(in_strong_cell, 4);
}

TEST(SpreadTest, KeepsAllWhenThereAreFewAndEachOnce) {
  const auto keypoints = RandomKeypoints(50, 3);
  const std::vector<int> picked = SpreadEvenly(keypoints, kCellPx, 1000);
  EXPECT_EQ(std::set<int>(picked.begin(), picked.end()).size(), 50U);
  EXPECT_EQ(picked.size(), 50U);
  EXPECT_TRUE(SpreadEvenly({}, kCellPx, 10).empty());
}

TEST(SpreadTest, EqualResponsesKeepTheirOrder) {
  std::vector<cv::KeyPoint> keypoints(5, cv::KeyPoint(3.0F, 3.0F, 7.0F, 0.0F, 1.0F));
  EXPECT_EQ(SpreadEvenly(keypoints, kCellPx, 3), (std::vector<int>{0, 1, 2}));
}

}  // namespace
}  // namespace floorloc
