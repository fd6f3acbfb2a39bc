// SPDX-License-Identifier: Apache-2.0
#include "core/lattice/self_similarity.h"

#include <gtest/gtest.h>

#include <random>

namespace floorloc {
namespace {

constexpr int kBytes = 32;
constexpr int kPoints = 3000;

// Random points with random descriptors; a share of them has a duplicate `shift_m` away whose descriptor differs in a
// few bits.
MapKeypoints MakeMap(double duplicate_share, float shift_m) {
  std::mt19937 random(5);
  MapKeypoints map;
  map.descriptors = cv::Mat(0, kBytes, CV_8UC1);
  for (int i = 0; i < kPoints; ++i) {
    Keypoint k;
    k.x_m = static_cast<float>(random() % 2000) * 1e-3F;
    k.y_m = static_cast<float>(random() % 2000) * 1e-3F;
    cv::Mat row(1, kBytes, CV_8UC1);
    for (int b = 0; b < kBytes; ++b) {
      row.at<std::uint8_t>(0, b) = static_cast<std::uint8_t>(random() % 256);
    }
    map.keypoints.push_back(k);
    map.descriptors.push_back(row);
    if (i < duplicate_share * kPoints) {
      k.x_m += shift_m;
      for (int flip = 0; flip < 8; ++flip) {
        row.at<std::uint8_t>(0, static_cast<int>(random() % kBytes)) ^= static_cast<std::uint8_t>(1U << (random() % 8));
      }
      map.keypoints.push_back(k);
      map.descriptors.push_back(row);
    }
  }
  return map;
}

bool Repeats(const MapKeypoints& map) {
  return IsSelfSimilar(map, *CreateDescriptorIndex(map.descriptors, {MatcherType::kBruteForce}), {}, 1);
}

TEST(SelfSimilarityTest, AFloorOfOneOffPointsDoesNotRepeatItself) { EXPECT_FALSE(Repeats(MakeMap(0.0, 3.0F))); }

TEST(SelfSimilarityTest, AFloorOfDuplicatesIsSelfSimilar) { EXPECT_TRUE(Repeats(MakeMap(1.0, 3.0F))); }

TEST(SelfSimilarityTest, FewDuplicatesAreNoRepetition) { EXPECT_FALSE(Repeats(MakeMap(0.2, 3.0F))); }

TEST(SelfSimilarityTest, TwoDescriptorsOfOnePointAreNoDuplicates) { EXPECT_FALSE(Repeats(MakeMap(1.0, 0.01F))); }

TEST(SelfSimilarityTest, OfFloatDescriptorsAndEmptyMapsNothingIsKnown) {
  MapKeypoints map;
  map.keypoints.resize(100);
  map.descriptors = cv::Mat::zeros(100, 64, CV_32FC1);
  EXPECT_FALSE(Repeats(map));
  map.keypoints.clear();
  map.descriptors = cv::Mat(0, kBytes, CV_8UC1);
  EXPECT_FALSE(IsSelfSimilar(map, *CreateDescriptorIndex(map.descriptors, {MatcherType::kBruteForce}), {}, 1));
}

}  // namespace
}  // namespace floorloc
