// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/adaptive_evaluation.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <stdexcept>

namespace floorloc {
namespace {

// Harris takes 10 ms and has 30 inliers, FAST 1 ms and 5.
AdaptiveFrame Frame(TextureClass texture) {
  AdaptiveFrame frame;
  frame.texture = texture;
  frame.assess_ms = 0.25;
  frame.detectors[0] = DetectionScore{10.0, 100, 60, 30, Pose2(0.1, 0.0, 0.0)};
  frame.detectors[2] = DetectionScore{1.0, 50, 10, 5, Pose2(0.2, 0.0, 0.0)};
  return frame;
}

std::vector<AdaptiveFrame> Drive(const std::vector<TextureClass>& textures) {
  std::vector<AdaptiveFrame> frames;
  for (const TextureClass texture : textures) {
    frames.push_back(Frame(texture));
  }
  return frames;
}

const DetectorMethod kHybrid{"FAST / Harris", ArticleDetector::kHarris, ArticleDetector::kFast, 2};

TEST(AdaptiveEvaluation, AChangeOfTheDetectorCostsTheImageBeforeAgain) {
  using enum TextureClass;
  // The counter: 2 (fast), 3, 2, 1 (stable), 1.
  const std::vector<MethodFrame> frames = RunMethod(kHybrid, Drive({kRough, kRough, kSmooth, kSmooth, kUnknown}));
  ASSERT_EQ(frames.size(), 4U);
  EXPECT_DOUBLE_EQ(frames[0].milliseconds, 1.25);
  EXPECT_DOUBLE_EQ(frames[1].milliseconds, 1.25);
  EXPECT_DOUBLE_EQ(frames[2].milliseconds, 10.0 + 10.0 + 0.25);
  EXPECT_DOUBLE_EQ(frames[3].milliseconds, 10.25);
  EXPECT_TRUE(frames[2].changed);
  EXPECT_EQ(frames[1].inliers, 5);
  EXPECT_EQ(frames[3].inliers, 30);
  EXPECT_DOUBLE_EQ(frames[3].correct_share, 0.6);
}

TEST(AdaptiveEvaluation, OneDetectorAloneDoesNotPayForTheTexture) {
  using enum TextureClass;
  const DetectorMethod harris{"Harris", ArticleDetector::kHarris, ArticleDetector::kHarris, 2};
  for (const MethodFrame& frame : RunMethod(harris, Drive({kRough, kSmooth, kRough}))) {
    EXPECT_DOUBLE_EQ(frame.milliseconds, 10.0);
    EXPECT_FALSE(frame.changed);
  }
}

TEST(AdaptiveEvaluation, OneBitChangesWithEachImage) {
  using enum TextureClass;
  DetectorMethod hasty = kHybrid;
  hasty.bits = 1;
  int changes = 0;
  for (const MethodFrame& frame : RunMethod(hasty, Drive({kRough, kSmooth, kRough, kSmooth}))) {
    changes += frame.changed ? 1 : 0;
  }
  EXPECT_EQ(changes, 3);
}

TEST(AdaptiveEvaluation, NeedsDrivesAndTraining) { EXPECT_THROW(EvaluateAdaptive({}), std::invalid_argument); }

TEST(ArticleDetectors, KeepOutOfTheMask) {
  cv::Mat gray(240, 320, CV_8UC1);
  cv::RNG(3).fill(gray, cv::RNG::UNIFORM, 0, 255);
  cv::Mat mask(gray.size(), CV_8UC1, cv::Scalar(255));
  mask.colRange(0, 160).setTo(0);
  for (const ArticleDetector detector : kArticleDetectors) {
    const DetectFunction detect = MakeArticleDetector(detector);
    if (!detect) {
      continue;  // SURF was left out
    }
    const std::vector<cv::KeyPoint> keypoints = detect(gray, mask);
    EXPECT_FALSE(keypoints.empty()) << ToString(detector);
    for (const cv::KeyPoint& keypoint : keypoints) {
      EXPECT_GE(keypoint.pt.x, 158.0F) << ToString(detector);
    }
  }
}

}  // namespace
}  // namespace floorloc
