// SPDX-License-Identifier: Apache-2.0
#include "core/surface/classes/surface_classifier.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numeric>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "tests/core/surface/classes/model_test_support.h"

namespace floorloc {
namespace {

SurfaceImage Picture(cv::Size size, int level) {
  SurfaceImage image;
  image.color = cv::Mat(size, CV_8UC3, cv::Scalar::all(level));
  return image;
}

TEST(SurfaceClassifier, SaysTheClassOfSegmentsAndImage) {
  const SurfaceClassifier classifier(DarkOrBright());
  SurfaceImage image = Picture({90, 60}, 250);
  image.color.colRange(0, 30).setTo(cv::Scalar::all(5));
  const SurfaceResult result = classifier.Classify(image);
  EXPECT_EQ(result.label, 0) << "two thirds are bright";
  ASSERT_EQ(result.segments.size(), 2U);
  EXPECT_EQ(result.segments[0].label, 1);
  EXPECT_EQ(result.segments[1].label, 0);
  EXPECT_EQ(result.segments[1].box, cv::Rect(30, 0, 60, 60));
  EXPECT_NEAR(std::accumulate(result.probabilities.begin(), result.probabilities.end(), 0.0), 1.0, 1e-6);
  EXPECT_GT(result.score, 0.5);
  EXPECT_LT(result.score, result.segments[1].score) << "the dark third counts against it";
}

TEST(SurfaceClassifier, ReducesLargeImagesAndGivesBoxesOfTheOriginal) {
  SurfaceModel model = DarkOrBright();
  model.max_side_px = 64;
  SurfaceImage image = Picture({256, 128}, 5);
  image.depth_mm = cv::Mat(image.color.size(), CV_16UC1, cv::Scalar(900));
  image.intensity = cv::Mat(image.color.size(), CV_16UC1, cv::Scalar(1));
  const SurfaceResult result = SurfaceClassifier(model).Classify(image);
  EXPECT_EQ(result.label, 1);
  EXPECT_EQ(result.segment_of_pixel.size(), cv::Size(64, 32));
  EXPECT_EQ(result.segments.front().box, cv::Rect(0, 0, 256, 128));
}

TEST(SurfaceClassifier, SaysNothingOfWhatItCannotSee) {
  SurfaceModel model = DarkOrBright();
  model.features.groups = {FeatureGroup::kDepthIntensity};
  model.boosted.inputs = {{{FeatureGroup::kDepthIntensity}, std::vector<float>(6, 0.0F), std::vector<float>(6, 1.0F)}};
  model.boosted.weak.front().svm.vectors = SampleMatrix::Zero(2, 6);
  const SurfaceResult result = SurfaceClassifier(model).Classify(Picture({32, 32}, 5));
  EXPECT_THAT(result.probabilities, testing::Each(testing::FloatEq(0.5F))) << "no depth in the picture";
}

TEST(SurfaceClassifier, RefusesImagesThatDoNotFit) {
  const SurfaceClassifier classifier(DarkOrBright());
  SurfaceImage image = Picture({32, 32}, 5);
  image.depth_mm = cv::Mat::zeros(32, 32, CV_16UC1);
  EXPECT_THROW(classifier.Classify(image), std::invalid_argument) << "depth without intensity";
  image.intensity = cv::Mat::zeros(16, 16, CV_16UC1);
  EXPECT_THROW(classifier.Classify(image), std::invalid_argument) << "another size";
  EXPECT_THROW(classifier.Classify(SurfaceImage()), std::invalid_argument);
}

TEST(SurfaceModel, IsCheckedWhole) {
  SurfaceModel model = DarkOrBright();
  model.boosted.weak.front().svm.vectors = SampleMatrix::Zero(2, 7);
  EXPECT_THROW(SurfaceClassifier{model}, std::invalid_argument);
  model = DarkOrBright();
  model.classes = {"one"};
  EXPECT_THROW(SurfaceClassifier{model}, std::invalid_argument);
  model = DarkOrBright();
  model.boosted.weak.front().input = 1;
  EXPECT_THROW(SurfaceClassifier{model}, std::invalid_argument);
}

TEST(SurfaceModel, MayHaveNoNumberThatOverflows) {
  SurfaceModel model = DarkOrBright();
  model.boosted.weak.front().svm.weights(0, 0) = 1e30F;
  EXPECT_THROW(SurfaceClassifier{model}, std::invalid_argument);
  model = DarkOrBright();
  model.boosted.inputs.front().scale.front() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(SurfaceClassifier{model}, std::invalid_argument);
}

TEST(DecisionBlock, HasStepsAroundTheMargins) {
  EXPECT_EQ(DecisionBlock(-9.0F), 0);
  EXPECT_EQ(DecisionBlock(-1.5F), 1);
  EXPECT_EQ(DecisionBlock(-0.1F), 3);
  EXPECT_EQ(DecisionBlock(0.1F), 4);
  EXPECT_EQ(DecisionBlock(1.4F), 6);
  EXPECT_EQ(DecisionBlock(1e30F), 7);
  EXPECT_EQ(DecisionBlock(std::numeric_limits<float>::quiet_NaN()), 0);
}

}  // namespace
}  // namespace floorloc
