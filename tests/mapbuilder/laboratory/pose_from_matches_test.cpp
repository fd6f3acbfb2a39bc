// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/pose_from_matches.h"

#include <gtest/gtest.h>

#include <random>

namespace floorloc {
namespace {

const Pose2 kTruth(1.2, 0.7, 2.5);

// A frame of 40 keypoints in a map: the first `right` matches are inliers with a low ratio, the others outliers with a
// high one.
struct Scene {
  Features frame, map;
  std::vector<Match> matches;

  explicit Scene(int right) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> position(0.0F, 0.4F);
    for (int i = 0; i < 40; ++i) {
      frame.keypoints.push_back({position(random), position(random), 0.3F, 0.01F, 1.0F});
      const Eigen::Vector2d in_map = i < right ? Eigen::Vector2d(kTruth * frame.keypoints.back().Position())
                                               : Eigen::Vector2d(3.0 * position(random), 3.0 * position(random));
      map.keypoints.push_back(
          {static_cast<float>(in_map.x()), static_cast<float>(in_map.y()), 0.3F + 2.5F, 0.01F, 1.0F});
      matches.push_back({i, i, i < right ? 1.0F : 9.0F, 10.0F});
    }
  }
};

void ExpectTruth(const MatchedPose& pose) {
  ASSERT_TRUE(pose.map_from_base.has_value());
  EXPECT_LT(pose.map_from_base->Between(kTruth).Log().norm(), 1e-5);
}

TEST(ComputePose, RatioTestDropsUnclearMatches) {
  const Scene scene(25);
  const MatchedPose pose = ComputePose(scene.matches, scene.frame, scene.map, MatchFilter::kRatio, {});
  EXPECT_EQ(pose.matches.size(), 25U);
  EXPECT_EQ(pose.inliers, 25);
  ExpectTruth(pose);
}

TEST(ComputePose, RansacFindsTheMatchesThatAgree) {
  const Scene scene(25);
  const MatchedPose pose = ComputePose(scene.matches, scene.frame, scene.map, MatchFilter::kRansac, {});
  EXPECT_EQ(pose.matches.size(), 25U);
  ExpectTruth(pose);
}

TEST(ComputePose, WithoutAFilterWrongMatchesCount) {
  const Scene scene(25);
  const MatchedPose pose = ComputePose(scene.matches, scene.frame, scene.map, MatchFilter::kNone, {});
  EXPECT_EQ(pose.matches.size(), 40U);
  ASSERT_TRUE(pose.map_from_base.has_value());
  EXPECT_GT(pose.map_from_base->Between(kTruth).Log().norm(), 0.01);
}

TEST(ComputePose, WeightedMeanWeighsCloseDescriptorsMore) {
  PoseFromMatchesOptions options;
  options.fit = PoseFit::kWeightedMean;
  const Scene all_right(40);
  ExpectTruth(ComputePose(all_right.matches, all_right.frame, all_right.map, MatchFilter::kNone, options));
  Scene scene(39);
  const auto error_m = [&](float distance_of_the_wrong_one) {
    scene.matches.back().distance = distance_of_the_wrong_one;
    const MatchedPose pose = ComputePose(scene.matches, scene.frame, scene.map, MatchFilter::kNone, options);
    return pose.map_from_base->Between(kTruth).translation().norm();
  };
  EXPECT_GT(error_m(1.0F), 5.0 * error_m(9.0F));
}

TEST(ComputePose, NeedsTwoMatches) {
  Scene scene(40);
  scene.matches.resize(1);
  for (const MatchFilter filter :
       {MatchFilter::kNone, MatchFilter::kRatio, MatchFilter::kRansac, MatchFilter::kRatioRansac}) {
    EXPECT_FALSE(ComputePose(scene.matches, scene.frame, scene.map, filter, {}).map_from_base.has_value());
  }
}

TEST(ComputePose, AnAnswerOfTheWrongScaleIsNone) {
  Scene scene(40);
  for (Keypoint& k : scene.map.keypoints) {
    k.x_m *= 1.2F;
    k.y_m *= 1.2F;
  }
  EXPECT_FALSE(ComputePose(scene.matches, scene.frame, scene.map, MatchFilter::kRansac, {}).map_from_base.has_value());
}

}  // namespace
}  // namespace floorloc
