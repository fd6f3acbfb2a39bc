// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/surface/patch_tracker.h"

#include <gtest/gtest.h>

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace floorloc {
namespace {

cv::Mat Spots(cv::Size size) {
  cv::Mat image(size, CV_8UC1);
  cv::RNG(2).fill(image, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(image, image, {}, 1.5);
  cv::normalize(image, image, 0, 255, cv::NORM_MINMAX);
  return image;
}

std::vector<cv::KeyPoint> Corners(const cv::Mat& gray) {
  std::vector<cv::KeyPoint> keypoints;
  cv::GFTTDetector::create(300, 0.01, 5.0)->detect(gray, keypoints);
  return keypoints;
}

TEST(PatchTracker, FindsAShiftAndItsMatches) {
  const cv::Mat floor = Spots({420, 320});
  const cv::Mat first = floor(cv::Rect(20, 20, 320, 240));
  const cv::Mat second = floor(cv::Rect(35, 12, 320, 240));  // the view moves right and up
  const PatchedImage a = CutPatches(first, Corners(first));
  const PatchedImage b = CutPatches(second, Corners(second));
  const std::vector<PatchMatch> matches = MatchPatches(a, b);
  ASSERT_GT(matches.size(), 100U);
  const PatchMotion motion = EstimatePatchMotion(a, b, matches);
  EXPECT_GT(motion.inliers.size(), 9 * matches.size() / 10);
  EXPECT_NEAR(motion.second_from_first.x(), -15.0, 0.2);
  EXPECT_NEAR(motion.second_from_first.y(), 8.0, 0.2);
  EXPECT_NEAR(motion.second_from_first.yaw(), 0.0, 0.002);
}

TEST(PatchTracker, PartnersBeyondTheWindowAreNotFound) {
  const cv::Mat floor = Spots({600, 240});
  const cv::Mat first = floor(cv::Rect(0, 0, 320, 240));
  const cv::Mat second = floor(cv::Rect(80, 0, 320, 240));  // a quarter of the image
  const PatchedImage a = CutPatches(first, Corners(first));
  const PatchedImage b = CutPatches(second, Corners(second));
  EXPECT_LT(EstimatePatchMotion(a, b, MatchPatches(a, b)).inliers.size(), 10U);
  PatchTrackerOptions wide;
  wide.window_share = 0.3;
  EXPECT_GT(EstimatePatchMotion(a, b, MatchPatches(a, b, wide)).inliers.size(), 50U);
}

TEST(PatchTracker, BrightnessAndContrastDoNotMatter) {
  const cv::Mat first = Spots({320, 240});
  cv::Mat second;
  first.convertTo(second, CV_8UC1, 0.4, 90.0);
  const std::vector<cv::KeyPoint> corners = Corners(first);
  const PatchedImage a = CutPatches(first, corners);
  const PatchedImage b = CutPatches(second, corners);
  ASSERT_EQ(a.points.size(), b.points.size());
  const std::vector<PatchMatch> matches = MatchPatches(a, b);
  EXPECT_EQ(matches.size(), a.points.size());
  for (const PatchMatch& match : matches) {
    EXPECT_EQ(match.first, match.second);
  }
}

TEST(PatchTracker, FlatPatchesAndThoseAtTheEdgeAreLeftOut) {
  const cv::Mat flat(60, 80, CV_8UC1, cv::Scalar(77));
  EXPECT_TRUE(CutPatches(flat, {cv::KeyPoint(40.0F, 30.0F, 7.0F)}).points.empty());
  EXPECT_TRUE(CutPatches(Spots({80, 60}), {cv::KeyPoint(2.0F, 30.0F, 7.0F)}).points.empty());
  EXPECT_EQ(CutPatches(Spots({80, 60}), {cv::KeyPoint(3.0F, 30.0F, 7.0F)}).points.size(), 1U);
  EXPECT_TRUE(EstimatePatchMotion({}, {}, {}).inliers.empty());
}

TEST(PatchTracker, OptionsAreChecked) {
  PatchTrackerOptions options;
  options.patch_px = 8;
  EXPECT_THROW(options.Check(), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
