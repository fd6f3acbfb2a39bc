// SPDX-License-Identifier: Apache-2.0
#include "core/surface/texture/adaboost.h"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

namespace floorloc {
namespace {

// Points of the unit cube; inside a band between two parallel planes through no corner the label is +1: no single plane
// through the origin can tell them.
std::vector<TextureSample> Band(int count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<TextureSample> samples;
  for (int i = 0; i < count; ++i) {
    const TextureFeatures x(unit(random), unit(random), unit(random), unit(random));
    const double ratio = x(1) / (x(0) + 0.1);
    samples.push_back({x, ratio > 0.5 && ratio < 1.5 ? 1 : -1});
  }
  return samples;
}

std::vector<TextureSample> Scaled(std::vector<TextureSample> samples, const TextureFeatures& factor) {
  for (TextureSample& sample : samples) {
    sample.features = sample.features.cwiseProduct(factor);
  }
  return samples;
}

TEST(AdaBoost, OnePlaneIsFoundExactly) {
  std::vector<TextureSample> samples = Band(300, 1);
  for (TextureSample& sample : samples) {
    sample.label = sample.features.dot(TextureFeatures(1.0, -0.4, -0.6, 0.2)) > 0.0 ? 1 : -1;
  }
  const StrongClassifier found = TrainAdaBoost(samples, {.classifiers = 30});
  EXPECT_LE(found.error, 0.01);
  EXPECT_LE(found.weak.size(), 30U);
}

TEST(AdaBoost, ManyWeakOnesDoWhatOneCannot) {
  const std::vector<TextureSample> samples = Band(400, 2);
  const StrongClassifier strong = TrainAdaBoost(samples, {.classifiers = 40});
  const std::vector<double> training = LearningCurve(strong, samples);
  const std::vector<double> unseen = LearningCurve(strong, Band(400, 3));
  EXPECT_GT(training.front(), 0.15);
  EXPECT_LT(training.back(), 0.5 * training.front());
  EXPECT_LT(unseen.back(), 0.15);
  EXPECT_EQ(strong.error, training.back());
}

TEST(AdaBoost, TheTrainingErrorStaysBelowItsBound) {
  // Product of 2 sqrt(e (1 - e)) over the weighted errors e (Freund & Schapire 1997), here by the reliabilities:
  // 2 sqrt(e (1 - e)) = 1 / cosh(alpha).
  const std::vector<TextureSample> samples = Band(300, 4);
  const StrongClassifier strong = TrainAdaBoost(samples, {.classifiers = 20});
  const std::vector<double> training = LearningCurve(strong, samples);
  double bound = 1.0;
  for (std::size_t t = 0; t < strong.weak.size(); ++t) {
    bound /= std::cosh(strong.weak[t].alpha);
    EXPECT_LE(training[t], bound + 1e-12) << t;
  }
}

TEST(AdaBoost, UnitsDoNotMatter) {
  const TextureFeatures factor(100.0, 2000.0, 0.03, 0.01);
  const std::vector<TextureSample> samples = Band(200, 5);
  const StrongClassifier plain = TrainAdaBoost(samples, {.classifiers = 10});
  const StrongClassifier scaled = TrainAdaBoost(Scaled(samples, factor), {.classifiers = 10});
  EXPECT_NEAR(plain.error, scaled.error, 0.03);
}

TEST(AdaBoost, EqualInputGivesEqualClassifiers) {
  const std::vector<TextureSample> samples = Band(100, 6);
  const StrongClassifier first = TrainAdaBoost(samples, {.classifiers = 5});
  const StrongClassifier second = TrainAdaBoost(samples, {.classifiers = 5});
  ASSERT_EQ(first.weak.size(), second.weak.size());
  for (std::size_t i = 0; i < first.weak.size(); ++i) {
    EXPECT_EQ(first.weak[i].weights, second.weak[i].weights);
    EXPECT_EQ(first.weak[i].alpha, second.weak[i].alpha);
  }
}

TEST(AdaBoost, OneClassIsNotEnough) {
  std::vector<TextureSample> samples = Band(20, 7);
  for (TextureSample& sample : samples) {
    sample.label = 1;
  }
  EXPECT_THROW(TrainAdaBoost(samples), std::invalid_argument);
  EXPECT_THROW(TrainAdaBoost({}), std::invalid_argument);
}

TEST(StrongClassifierScore, IsTheWeightedVote) {
  StrongClassifier strong;
  strong.weak = {{TextureFeatures(1.0, 0.0, 0.0, 0.0), 1, 3.0}, {TextureFeatures(0.0, 1.0, 0.0, 0.0), -1, 1.0}};
  EXPECT_DOUBLE_EQ(strong.Score(TextureFeatures(1.0, 1.0, 0.0, 0.0)), 0.5);
  EXPECT_DOUBLE_EQ(strong.Score(TextureFeatures(1.0, -1.0, 0.0, 0.0)), 1.0);
  EXPECT_DOUBLE_EQ(StrongClassifier().Score(TextureFeatures::Ones()), 0.0);
}

}  // namespace
}  // namespace floorloc
