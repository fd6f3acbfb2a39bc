// SPDX-License-Identifier: Apache-2.0
#include "core/surface/classes/segmentation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/ximgproc/segmentation.hpp>
#include <set>
#include <stdexcept>
#include <vector>

namespace floorloc {
namespace {

// Noisy fields of different colours.
cv::Mat Fields(int rows, int columns) {
  cv::Mat image(rows, columns, CV_8UC3, cv::Scalar(90, 100, 110));
  image(cv::Rect(0, 0, columns / 2, rows / 2)).setTo(cv::Scalar(200, 60, 40));
  image(cv::Rect(columns / 2, rows / 3, columns / 2, rows - rows / 3)).setTo(cv::Scalar(30, 160, 60));
  cv::Mat noise(image.size(), CV_8UC3);
  cv::RNG(3).fill(noise, cv::RNG::UNIFORM, 0, 6);
  return image + noise;
}

// Of pairs of pixels at most 30 px apart, the share that both segmentations join or both part.
double Agreement(const cv::Mat& a, const cv::Mat& b) {
  cv::RNG random(1);
  int agree = 0;
  constexpr int kPairs = 50'000;
  for (int i = 0; i < kPairs; ++i) {
    const cv::Point p(random.uniform(0, a.cols), random.uniform(0, a.rows));
    const cv::Point q(std::clamp(p.x + random.uniform(-30, 31), 0, a.cols - 1),
                      std::clamp(p.y + random.uniform(-30, 31), 0, a.rows - 1));
    agree += (a.at<int>(p) == a.at<int>(q)) == (b.at<int>(p) == b.at<int>(q)) ? 1 : 0;
  }
  return static_cast<double>(agree) / kPairs;
}

TEST(Segmentation, FindsFieldsOfDifferentColours) {
  const cv::Mat image = Fields(120, 160);
  const Segmentation found = SegmentImage(image, SegmentationOptions());
  EXPECT_EQ(found.count, 4);
  const std::set<int> different = {found.labels.at<int>(20, 20), found.labels.at<int>(10, 150),
                                   found.labels.at<int>(100, 150), found.labels.at<int>(110, 10)};
  EXPECT_EQ(different.size(), 4U);
}

TEST(Segmentation, IsThatOfOpenCvOnFieldsWithNoise) {
  const cv::Mat image = Fields(240, 320);
  SegmentationOptions options;
  options.min_size_px = 100;
  const Segmentation ours = SegmentImage(image, options);
  cv::Mat theirs;
  cv::ximgproc::segmentation::createGraphSegmentation(options.sigma_px, static_cast<float>(options.k),
                                                      options.min_size_px)
      ->processImage(image, theirs);
  EXPECT_GT(Agreement(ours.labels, theirs), 0.97);
}

TEST(Segmentation, LabelsCountFromZeroInTheOrderOfTheirFirstPixels) {
  const Segmentation found = SegmentImage(Fields(90, 160), SegmentationOptions());
  int next = 0;
  for (int y = 0; y < found.labels.rows; ++y) {
    for (int x = 0; x < found.labels.cols; ++x) {
      ASSERT_LE(found.labels.at<int>(y, x), next);
      next += found.labels.at<int>(y, x) == next ? 1 : 0;
    }
  }
  EXPECT_EQ(next, found.count);
}

TEST(Segmentation, LeavesNoSegmentBelowTheMinimum) {
  cv::Mat image(100, 100, CV_8UC3);
  cv::RNG(5).fill(image, cv::RNG::UNIFORM, 0, 256);
  SegmentationOptions options;
  options.k = 1.0;
  options.min_size_px = 150;
  const Segmentation found = SegmentImage(image, options);
  std::vector<int> pixels(static_cast<std::size_t>(found.count), 0);
  for (const int label : cv::Mat_<int>(found.labels)) {
    ++pixels[static_cast<std::size_t>(label)];
  }
  EXPECT_THAT(pixels, testing::Each(testing::Ge(options.min_size_px)));
  EXPECT_GT(found.count, 10);
}

TEST(Segmentation, LargerKGivesFewerSegments) {
  cv::Mat image(120, 160, CV_8UC3);
  cv::RNG(5).fill(image, cv::RNG::UNIFORM, 0, 200);
  cv::GaussianBlur(image, image, {}, 3.0);
  SegmentationOptions few;
  few.min_size_px = 20;
  SegmentationOptions many = few;
  many.k = 50.0;
  EXPECT_LT(SegmentImage(image, few).count, SegmentImage(image, many).count);
}

TEST(Segmentation, TakesImagesOfOnePixelAndOneRow) {
  EXPECT_EQ(SegmentImage(cv::Mat(1, 1, CV_8UC3, cv::Scalar(1, 2, 3)), SegmentationOptions()).count, 1);
  EXPECT_EQ(SegmentImage(cv::Mat(1, 9, CV_8UC3, cv::Scalar(1, 2, 3)), SegmentationOptions()).count, 1);
  EXPECT_THROW(SegmentImage(cv::Mat(4, 4, CV_8UC1), SegmentationOptions()), std::invalid_argument);
  EXPECT_THROW(SegmentImage(cv::Mat(), SegmentationOptions()), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
