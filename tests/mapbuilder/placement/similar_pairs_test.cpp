// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/similar_pairs.h"

#include <gtest/gtest.h>

#include <numeric>
#include <opencv2/core.hpp>
#include <set>

namespace floorloc {
namespace {

// Every frame is its own part.
std::vector<int> Alone(std::size_t count) {
  std::vector<int> part(count);
  std::iota(part.begin(), part.end(), 0);
  return part;
}

TEST(SimilarPairsTest, AreFramesWithTheSameDescriptors) {
  std::vector<BuildFrame> frames(20);
  cv::RNG random(1);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    cv::Mat& descriptors = frames[i].features.descriptors;
    descriptors = cv::Mat(100, 32, CV_8U);
    random.fill(descriptors, cv::RNG::UNIFORM, 0, 256);
    if (i >= 10) {  // frame i shares half of its floor with frame i - 10
      frames[i - 10].features.descriptors.rowRange(0, 50).copyTo(descriptors.rowRange(50, 100));
    }
  }
  std::set<std::pair<int, int>> found;
  for (const FramePair& pair : SelectSimilarPairs(frames, Alone(frames.size()), {2, {.threads = 1}})) {
    found.emplace(pair.first, pair.second);
    EXPECT_LT(pair.first, pair.second);
    EXPECT_FALSE(pair.first_from_second);
  }
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(found.contains({i, i + 10})) << i;
  }
  EXPECT_LE(found.size(), 40U);
}

// Two drives over the same floor: each frame is most similar to its neighbours of the same drive.
TEST(SimilarPairsTest, AFramesOwnPartDoesNotHideTheOthers) {
  constexpr std::size_t kHalf = 60;
  std::vector<BuildFrame> frames(2 * kHalf);
  cv::RNG random(2);
  cv::Mat floor(40 * static_cast<int>(kHalf) + 200, 32, CV_8U);
  random.fill(floor, cv::RNG::UNIFORM, 0, 256);
  std::vector<int> part;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const int start = 40 * static_cast<int>(i % kHalf);
    cv::Mat descriptors = floor.rowRange(start, start + 200).clone();
    descriptors.col(0) = cv::Scalar(i < kHalf ? 0 : 255);  // the drives differ slightly
    frames[i].features.descriptors = descriptors;
    part.push_back(i < kHalf ? 0 : 1);
  }
  const std::vector<FramePair> pairs = SelectSimilarPairs(frames, part, {3, {.threads = 2}});
  std::set<std::pair<int, int>> found;
  for (const FramePair& pair : pairs) {
    EXPECT_NE(part[static_cast<std::size_t>(pair.first)], part[static_cast<std::size_t>(pair.second)]);
    found.emplace(pair.first, pair.second);
  }
  for (int i = 0; i < static_cast<int>(kHalf); ++i) {
    EXPECT_TRUE(found.contains({i, i + static_cast<int>(kHalf)})) << i;
  }
}

TEST(SimilarPairsTest, FramesWithoutTextureHaveNone) {
  EXPECT_TRUE(SelectSimilarPairs(std::vector<BuildFrame>(3), Alone(3), {2, {.threads = 1}}).empty());
}

}  // namespace
}  // namespace floorloc
