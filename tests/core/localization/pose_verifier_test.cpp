// SPDX-License-Identifier: Apache-2.0
#include "core/localization/pose_verifier.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <random>

namespace floorloc {
namespace {

constexpr int kBytes = 32;
constexpr int kTilesAside = 12;
constexpr double kKeypointsPerM2 = 6000.0;
constexpr int kChangedBits = 6;  // in each copy of a point

// A floor of equal tiles; the descriptors of a point's copies differ slightly.
class TiledFloor {
 public:
  explicit TiledFloor(int keypoints_per_tile) : side_m_(std::sqrt(keypoints_per_tile / kKeypointsPerM2)) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(0.0F, 1.0F);
    std::vector<Keypoint> tile;
    cv::Mat descriptors(keypoints_per_tile, kBytes, CV_8U);
    for (int i = 0; i < keypoints_per_tile; ++i) {
      const auto side = static_cast<float>(side_m_);
      Keypoint keypoint;
      keypoint.x_m = side * unit(random);
      keypoint.y_m = side * unit(random);
      keypoint.angle_rad = 2.0F * std::numbers::pi_v<float> * unit(random);
      keypoint.size_m = 0.01F;
      tile.push_back(keypoint);
      for (int b = 0; b < kBytes; ++b) {
        descriptors.at<std::uint8_t>(i, b) = static_cast<std::uint8_t>(random());
      }
    }
    for (int copy = 0; copy < kTilesAside * kTilesAside; ++copy) {
      AddCopy(tile, descriptors, copy, &random);
    }
    map_.info.area_m2 = std::pow(kTilesAside * side_m_, 2);
  }

  const FloorMap& map() const { return map_; }
  float MaxDistance() const {
    const GuidedMatcher matcher(map_.keypoints.keypoints, map_.keypoints.descriptors, 0.05);
    return PoseVerifier(map_, matcher, RegistrationOptions(), VerificationOptions(), VerifiedBy::kOwnAngles)
        .max_distance();
  }

 private:
  void AddCopy(const std::vector<Keypoint>& tile, const cv::Mat& descriptors, int copy, std::mt19937* random) {
    for (std::size_t i = 0; i < tile.size(); ++i) {
      Keypoint keypoint = tile[i];
      const int column = copy % kTilesAside;
      const int row_of_copy = copy / kTilesAside;
      keypoint.x_m += static_cast<float>(side_m_ * column);
      keypoint.y_m += static_cast<float>(side_m_ * row_of_copy);
      cv::Mat row = descriptors.row(static_cast<int>(i)).clone();
      for (int flip = 0; flip < kChangedBits; ++flip) {
        row.at<std::uint8_t>(0, static_cast<int>((*random)() % kBytes)) ^=
            static_cast<std::uint8_t>(1U << ((*random)() % 8));
      }
      map_.keypoints.keypoints.push_back(keypoint);
      map_.keypoints.observations.push_back(3);
      map_.keypoints.descriptors.push_back(row);
    }
  }

  double side_m_;
  FloorMap map_;
};

// For random 256-bit descriptors, 1 % of the pairs differ by fewer than 128 - 2.33 * 8 bits.
TEST(PoseVerifierTest, WhatIsAlikeDoesNotDependOnTheSizeOfATile) {
  for (const int keypoints : {20, 45, 90, 110, 200, 1000}) {
    EXPECT_NEAR(static_cast<double>(TiledFloor(keypoints).MaxDistance()), 109.0, 3.0) << keypoints;
  }
}

TEST(PoseVerifierTest, AViewOfATileFindsItsKeypoints) {
  const TiledFloor floor(45);
  const MapKeypoints& map = floor.map().keypoints;
  const GuidedMatcher matcher(map.keypoints, map.descriptors, 0.05);
  const PoseVerifier verifier(floor.map(), matcher, RegistrationOptions(), VerificationOptions(),
                              VerifiedBy::kOwnAngles);
  Features view;
  std::mt19937 random(7);
  for (int i = 0; i < 500; ++i) {
    view.keypoints.push_back(map.keypoints[static_cast<std::size_t>(i)]);
    cv::Mat row = map.descriptors.row(i).clone();
    for (int flip = 0; flip < 40; ++flip) {  // noise far above the differences between copies
      row.at<std::uint8_t>(0, static_cast<int>(random() % kBytes)) ^= static_cast<std::uint8_t>(1U << (random() % 8));
    }
    view.descriptors.push_back(row);
  }
  const VerifiedPose pose = verifier.Verify(view, Pose2());
  EXPECT_GT(pose.candidate.inliers.size(), 450U);
  EXPECT_LT(pose.candidate.log10_nfa, -20.0);
}

}  // namespace
}  // namespace floorloc
