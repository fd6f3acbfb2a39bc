// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/surface/boosting.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/ml.hpp>
#include <random>

#include "core/surface/classes/surface_classifier.h"
#include "mapbuilder/surface/sharpness.h"

namespace floorloc {
namespace {

// Three classes, of which "value" parts the first from the others, and "shape" the second from the others.
std::vector<LabelledSegment> Segments(int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<float> noise(0.0F, 0.3F);
  std::vector<LabelledSegment> segments;
  for (int i = 0; i < count; ++i) {
    LabelledSegment segment;
    segment.label = i % 3;
    segment.features.pixels = 100;
    auto& value = segment.features.groups[static_cast<std::size_t>(FeatureGroup::kValue)];
    auto& shape = segment.features.groups[static_cast<std::size_t>(FeatureGroup::kShape)];
    value.assign(8, 0.0F);
    shape.assign(14, 0.0F);
    value[0] = (segment.label == 0 ? 1.0F : -1.0F) + noise(random);
    shape[0] = (segment.label == 1 ? 1.0F : -1.0F) + noise(random);
    segments.push_back(segment);
  }
  return segments;
}

double ShareRight(const BoostedSvm& boosted, const std::vector<LabelledSegment>& segments) {
  int right = 0;
  for (const LabelledSegment& segment : segments) {
    Eigen::Index said = 0;
    boosted.Decide({&segment.features, 1}).row(0).maxCoeff(&said);
    right += said == segment.label ? 1 : 0;
  }
  return static_cast<double>(right) / static_cast<double>(segments.size());
}

BoostedSvm BoostOf(const std::vector<LabelledSegment>& segments, const std::vector<FeatureGroup>& groups, int rounds,
                   int threads = 1) {
  std::vector<SvmInput> inputs;
  std::vector<SvmParameters> parameters;
  for (const FeatureGroup group : groups) {
    inputs.push_back(Standardise({group}, segments));
    parameters.push_back({1.0, 0.1});
  }
  BoostingOptions options;
  options.rounds = rounds;
  options.weak_samples = 60;
  options.threads = threads;
  return Boost(segments, 3, inputs, parameters, options);
}

TEST(KernelSvm, DecidesAsOpenCvDoes) {
  SampleMatrix samples(60, 2);
  std::vector<int> labels;
  cv::Mat rows(60, 2, CV_32FC1);
  cv::Mat sides(60, 1, CV_32SC1);
  std::mt19937_64 random(3);
  std::normal_distribution<float> noise(0.0F, 0.7F);
  for (int i = 0; i < 60; ++i) {
    samples(i, 0) = (i % 2 == 0 ? 1.0F : -1.0F) + noise(random);
    samples(i, 1) = noise(random);
    labels.push_back(i % 2);
    rows.at<float>(i, 0) = samples(i, 0);
    rows.at<float>(i, 1) = samples(i, 1);
    sides.at<int>(i) = i % 2 == 1 ? 1 : -1;
  }
  const cv::Ptr<cv::ml::SVM> svm = cv::ml::SVM::create();
  svm->setType(cv::ml::SVM::C_SVC);
  svm->setKernel(cv::ml::SVM::RBF);
  svm->setC(2.0);
  svm->setGamma(0.5);
  svm->setClassWeights((cv::Mat_<double>(2, 1) << 1.0, 1.0));
  svm->setTermCriteria({cv::TermCriteria::MAX_ITER + cv::TermCriteria::EPS, 2000, 1e-3});
  svm->train(rows, cv::ml::ROW_SAMPLE, sides);
  cv::Mat theirs;
  svm->predict(rows, theirs, cv::ml::StatModel::RAW_OUTPUT);
  const Eigen::MatrixXf ours = TrainKernelSvm(samples, labels, 2, {2.0, 0.5}).Decide(samples);
  for (int i = 0; i < 60; ++i) {
    EXPECT_NEAR(ours(i, 1), -theirs.at<float>(i), 1e-3) << "OpenCV's sum is positive for the smaller label";
    EXPECT_NEAR(ours(i, 0), -ours(i, 1), 0.05) << "the other side of the same margin";
  }
}

TEST(KernelSvm, KnowsClassesThatNoSampleHas) {
  const SampleMatrix samples = SampleMatrix::Random(6, 2);
  const std::vector<int> labels(6, 1);
  const Eigen::MatrixXf decisions = TrainKernelSvm(samples, labels, 3, {}).Decide(samples);
  EXPECT_TRUE((decisions.col(1).array() == 1.0F).all());
  EXPECT_TRUE((decisions.col(2).array() == -1.0F).all());
}

TEST(Boosting, JoinsInputsOfWhichNoneSuffices) {
  const std::vector<LabelledSegment> training = Segments(180, 1);
  const std::vector<LabelledSegment> others = Segments(300, 2);
  EXPECT_LT(ShareRight(BoostOf(training, {FeatureGroup::kValue}, 8), others), 0.75);
  EXPECT_LT(ShareRight(BoostOf(training, {FeatureGroup::kShape}, 8), others), 0.75);
  EXPECT_GT(ShareRight(BoostOf(training, {FeatureGroup::kValue, FeatureGroup::kShape}, 8), others), 0.95);
}

TEST(Boosting, IsTheSameForAnyNumberOfThreads) {
  const std::vector<LabelledSegment> training = Segments(90, 1);
  const BoostedSvm one = BoostOf(training, {FeatureGroup::kValue, FeatureGroup::kShape}, 3);
  const BoostedSvm two = BoostOf(training, {FeatureGroup::kValue, FeatureGroup::kShape}, 3, 2);
  const LabelledSegment& segment = training.front();
  EXPECT_EQ(one.Decide({&segment.features, 1}), two.Decide({&segment.features, 1}));
}

TEST(Boosting, SegmentsWithoutAnInputAreLeftToTheOthers) {
  std::vector<LabelledSegment> training = Segments(120, 1);
  for (std::size_t i = 0; i < training.size(); i += 2) {
    training[i].features.groups[static_cast<std::size_t>(FeatureGroup::kShape)].clear();
  }
  const BoostedSvm boosted = BoostOf(training, {FeatureGroup::kValue, FeatureGroup::kShape}, 8);
  SegmentFeatures empty;
  EXPECT_TRUE(boosted.Decide({&empty, 1}).isZero());
  EXPECT_GT(ShareRight(boosted, Segments(300, 2)), 0.9);
}

TEST(Standardise, MakesMeanZeroAndVarianceOneAndDropsWhatDoesNotVary) {
  const std::vector<LabelledSegment> segments = Segments(300, 1);
  const SvmInput input = Standardise({FeatureGroup::kValue}, segments);
  std::vector<SegmentFeatures> features;
  for (const LabelledSegment& segment : segments) {
    features.push_back(segment.features);
  }
  const SampleMatrix rows = input.Rows(features);
  EXPECT_NEAR(rows.col(0).mean(), 0.0, 1e-5);
  EXPECT_NEAR(rows.col(0).squaredNorm() / 300.0, 1.0, 1e-4);
  EXPECT_TRUE(rows.col(1).isZero());
}

TEST(Sharpness, MakesProbabilitiesWhatTheyClaim) {
  // 80 % of the labels are the class with the larger sum: the probability should be 0.8.
  std::vector<Eigen::RowVectorXf> sums;
  std::vector<int> labels;
  for (int i = 0; i < 100; ++i) {
    sums.push_back((Eigen::RowVectorXf(2) << 3.0F, 1.0F).finished());
    labels.push_back(i < 80 ? 0 : 1);
  }
  const float sharpness = FitSharpness(sums, labels);
  EXPECT_NEAR(Probabilities(sums.front(), sharpness).front(), 0.8, 1e-3);
}

}  // namespace
}  // namespace floorloc
