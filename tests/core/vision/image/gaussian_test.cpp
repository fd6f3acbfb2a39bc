// SPDX-License-Identifier: Apache-2.0
#include "core/vision/image/gaussian.h"

#include <gtest/gtest.h>

#include "tests/core/vision/vision_test_support.h"

namespace floorloc {
namespace {

using testing_vision::MakeTexture;

// The same with OpenCV, whose kernel has the same length.
cv::Mat OpenCvSmooth(const cv::Mat& image, double sigma_px) {
  cv::Mat levels;
  image.convertTo(levels, CV_32F);
  const int side = 2 * static_cast<int>(std::ceil(3.0 * sigma_px)) + 1;
  cv::Mat smooth;
  cv::GaussianBlur(levels, smooth, {side, side}, sigma_px, sigma_px, cv::BORDER_REFLECT);
  return smooth;
}

void ExpectAsOpenCv(const cv::Mat& image, double sigma_px) {
  const cv::Mat smooth = SmoothGaussian(image, sigma_px);
  ASSERT_EQ(smooth.type(), CV_32FC1);
  ASSERT_EQ(smooth.size(), image.size());
  EXPECT_LT(cv::norm(smooth, OpenCvSmooth(image, sigma_px), cv::NORM_INF), 1e-3) << image.size() << " " << sigma_px;
}

TEST(GaussianTest, AgreesWithOpenCv) {
  for (const double sigma_px : {0.3, 1.0, 2.5, 6.1}) {
    ExpectAsOpenCv(MakeTexture({161, 97}, 120.0, 40.0, 1), sigma_px);
  }
}

TEST(GaussianTest, AgreesWithOpenCvOnImagesSmallerThanTheKernel) {
  for (const cv::Size& size : {cv::Size(1, 1), cv::Size(1, 9), cv::Size(9, 1), cv::Size(2, 3), cv::Size(5, 4)}) {
    cv::Mat image(size, CV_8UC1);
    cv::RNG(2).fill(image, cv::RNG::UNIFORM, 0, 256);
    ExpectAsOpenCv(image, 1.0);
    ExpectAsOpenCv(image, 4.0);
  }
}

TEST(GaussianTest, TakesFloatsAndPartsOfImages) {
  const cv::Mat image = MakeTexture({120, 90}, 120.0, 40.0, 3);
  cv::Mat levels;
  image.convertTo(levels, CV_32F, 1.0, 0.25);
  ExpectAsOpenCv(levels, 2.0);
  const cv::Mat part = image(cv::Rect(10, 20, 53, 41));  // not continuous in memory
  EXPECT_TRUE(testing_vision::Same(SmoothGaussian(part, 2.0), SmoothGaussian(part.clone(), 2.0)));
}

TEST(GaussianTest, SigmaZeroOnlyConverts) {
  const cv::Mat image = MakeTexture({40, 30}, 120.0, 40.0, 4);
  cv::Mat levels;
  image.convertTo(levels, CV_32F);
  EXPECT_TRUE(testing_vision::Same(SmoothGaussian(image, 0.0), levels));
  EXPECT_FALSE(testing_vision::Same(SmoothGaussian(image, 0.5), levels));
}

TEST(GaussianTest, LeavesItsInputAlone) {
  cv::Mat levels(20, 20, CV_32F, cv::Scalar(1.0));
  levels.at<float>(10, 10) = 200.0F;
  const cv::Mat before = levels.clone();
  SmoothGaussian(levels, 1.5);
  EXPECT_TRUE(testing_vision::Same(levels, before));
}

TEST(GaussianTest, NothingOfNothing) { EXPECT_TRUE(SmoothGaussian(cv::Mat(0, 0, CV_8UC1), 1.0).empty()); }

}  // namespace
}  // namespace floorloc
