// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <opencv2/core.hpp>
#include <random>

#include "core/surface/classes/segment_features.h"
#include "core/surface/classes/shape_features.h"

namespace floorloc {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::FloatNear;
using testing::SizeIs;

FeatureOptions Only(FeatureGroup group) {
  FeatureOptions options;
  options.groups = {group};
  return options;
}

Segmentation Whole(cv::Size size) { return {cv::Mat::zeros(size, CV_32SC1), 1}; }

// The left half is segment 0, the right half segment 1.
Segmentation Halves(cv::Size size) {
  Segmentation halves{cv::Mat::zeros(size, CV_32SC1), 2};
  halves.labels.colRange(size.width / 2, size.width).setTo(1);
  return halves;
}

std::vector<float> Measure(const SurfaceImage& image, const Segmentation& segmentation, const FeatureOptions& options,
                           std::size_t segment = 0) {
  const std::vector<SegmentFeatures> features = ExtractFeatures(image, segmentation, options);
  const auto numbers = features.at(segment).Of(options.groups.front());
  return {numbers.begin(), numbers.end()};
}

TEST(Features, EveryGroupHasItsSize) {
  SurfaceImage image;
  image.color = cv::Mat(40, 40, CV_8UC3, cv::Scalar(10, 20, 30));
  image.depth_mm = cv::Mat(40, 40, CV_16UC1, cv::Scalar(1000));
  image.intensity = cv::Mat(40, 40, CV_16UC1, cv::Scalar(7));
  for (int g = 0; g < kFeatureGroups; ++g) {
    const auto group = static_cast<FeatureGroup>(g);
    EXPECT_THAT(Measure(image, Halves(image.color.size()), Only(group), 1), SizeIs(GroupSize(group)))
        << GroupName(group);
    EXPECT_EQ(ParseGroup(GroupName(group)), group);
  }
}

TEST(Features, HistogramsOfColourAreShares) {
  SurfaceImage image;
  image.color = cv::Mat(10, 20, CV_8UC3, cv::Scalar(0, 0, 255));  // red: hue 0, saturation and value 255
  image.color.colRange(0, 5).setTo(cv::Scalar(64, 64, 64));       // grey: saturation 0, value 64
  const Segmentation halves = Halves(image.color.size());
  const auto hue = Measure(image, halves, Only(FeatureGroup::kHueSaturation));
  EXPECT_FLOAT_EQ(hue[0], 0.5F);
  EXPECT_FLOAT_EQ(hue[3], 0.5F);
  const auto value = Measure(image, halves, Only(FeatureGroup::kValue));
  EXPECT_FLOAT_EQ(value[2], 0.5F);
  EXPECT_FLOAT_EQ(value[7], 0.5F);
  EXPECT_FLOAT_EQ(Measure(image, halves, Only(FeatureGroup::kValue), 1)[7], 1.0F) << "the other segment";
}

TEST(Features, ColourIsMeanAndCovariance) {
  SurfaceImage image;
  image.color = cv::Mat(10, 20, CV_8UC3, cv::Scalar(100, 100, 100));
  image.color.rowRange(0, 5).setTo(cv::Scalar(120, 120, 120));
  const auto color = Measure(image, Whole(image.color.size()), Only(FeatureGroup::kColor));
  EXPECT_THAT(color, ElementsAre(0.0F, 0.0F, 110.0F, 0, 0, 0, 0, 0, 0, 0, 0, FloatNear(100.0F, 0.01F)));
}

TEST(Features, RangeCountsOnlyPixelsWithDepth) {
  SurfaceImage image;
  image.color = cv::Mat(10, 20, CV_8UC3, cv::Scalar(1, 2, 3));
  image.depth_mm = cv::Mat::zeros(10, 20, CV_16UC1);
  image.intensity = cv::Mat(10, 20, CV_16UC1, cv::Scalar(60'000));  // in the holes: void
  image.depth_mm.rowRange(0, 2).colRange(0, 10).setTo(1500);
  image.intensity.rowRange(0, 2).colRange(0, 10).setTo(10);
  FeatureOptions options = Only(FeatureGroup::kDepthIntensity);
  options.max_intensity = 100.0F;
  const Segmentation halves = Halves(image.color.size());
  EXPECT_THAT(Measure(image, halves, options), ElementsAre(1.5F, 10.0F, 0, 0, 0, 0));
  EXPECT_THAT(Measure(image, halves, options, 1), SizeIs(0)) << "no depth in it at all";
  options.groups = {FeatureGroup::kIntensity};
  EXPECT_FLOAT_EQ(Measure(image, halves, options)[2], 1.0F) << "10 of 100 in 25 bins";
}

TEST(Features, PatternsSumToOneForEachRadiusAndDoNotTurn) {
  SurfaceImage image;
  image.color = cv::Mat(64, 64, CV_8UC3);
  cv::RNG(7).fill(image.color, cv::RNG::UNIFORM, 0, 256);
  const auto patterns = Measure(image, Whole(image.color.size()), Only(FeatureGroup::kPattern));
  for (int radius = 0; radius < 3; ++radius) {
    EXPECT_NEAR(std::accumulate(patterns.begin() + 10 * radius, patterns.begin() + 10 * (radius + 1), 0.0), 1.0, 1e-5);
  }
  SurfaceImage turned;
  cv::rotate(image.color, turned.color, cv::ROTATE_90_CLOCKWISE);
  const auto of_turned = Measure(turned, Whole(turned.color.size()), Only(FeatureGroup::kPattern));
  for (std::size_t i = 0; i < patterns.size(); ++i) {
    EXPECT_NEAR(patterns[i], of_turned[i], 1e-4) << i;
  }
}

TEST(Features, GradientsTellOneDirectionFromTwo) {
  SurfaceImage stripes;
  stripes.color = cv::Mat(64, 64, CV_8UC3, cv::Scalar::all(100));
  for (int x = 0; x < 64; x += 8) {
    stripes.color.colRange(x, x + 4).setTo(cv::Scalar::all(160));
  }
  SurfaceImage grid;
  grid.color = stripes.color.clone();
  for (int y = 0; y < 64; y += 8) {
    grid.color.rowRange(y, y + 4).setTo(cv::Scalar::all(130));
  }
  const FeatureOptions options = Only(FeatureGroup::kGradient);
  const auto one = Measure(stripes, Whole(stripes.color.size()), options);
  const auto two = Measure(grid, Whole(grid.color.size()), options);
  EXPECT_GT(one[2], 0.99) << "one direction";
  EXPECT_LT(two[2], 0.6);
  EXPECT_GT(two[3], 0.4) << "two perpendicular ones: noise has below 0.1";
}

TEST(BorderLines, AreTheSidesOfARectangle) {
  std::vector<cv::Point> border;
  for (int x = 0; x < 60; ++x) {
    border.emplace_back(x, 0);
    border.emplace_back(x, 40);
  }
  for (int y = 1; y < 40; ++y) {
    border.emplace_back(0, y);
    border.emplace_back(59, y);
  }
  std::mt19937_64 random(1);
  const std::vector<BorderLine> lines = FindBorderLines(border, &random);
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_NEAR(lines[0].length_px, 59.0, 2.0);
  EXPECT_NEAR(lines[3].length_px, 37.0, 4.0);
}

TEST(Features, ShapeOfARectangleIsRegular) {
  Segmentation segmentation{cv::Mat::zeros(100, 100, CV_32SC1), 2};
  segmentation.labels(cv::Rect(20, 30, 50, 40)).setTo(1);
  SurfaceImage image;
  image.color = cv::Mat(100, 100, CV_8UC3, cv::Scalar(1, 2, 3));
  const auto shape = Measure(image, segmentation, Only(FeatureGroup::kShape), 1);
  EXPECT_NEAR(shape[0], 1.0, 0.1) << "all of the border is straight";
  EXPECT_EQ(shape[3], 4.0F);
  EXPECT_NEAR(std::accumulate(shape.begin() + 4, shape.end(), 0.0), 1.0, 1e-5);
}

TEST(Features, ShapeOfTheWholeImageHasNoBorder) {
  SurfaceImage image;
  image.color = cv::Mat(50, 50, CV_8UC3, cv::Scalar(1, 2, 3));
  EXPECT_THAT(Measure(image, Whole(image.color.size()), Only(FeatureGroup::kShape)), Each(0.0F));
}

}  // namespace
}  // namespace floorloc
