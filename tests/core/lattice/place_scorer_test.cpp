// SPDX-License-Identifier: Apache-2.0
#include "core/lattice/place_scorer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace floorloc {
namespace {

constexpr std::size_t kSamples = 4000;

// A frame that shows the strong specks of a place half as strong, in noise; the mosaic of the place has noise, too.
class PlaceScorerTest : public testing::Test {
 protected:
  PlaceScorerTest() {
    std::mt19937 random(3);
    std::normal_distribution<float> normal;
    for (std::size_t i = 0; i < kSamples; ++i) {
      const float speck = i % 80 == 0 ? 20.0F : 0.0F;
      scales_.mean.push_back(100.0F);
      scales_.deviation.push_back(1.0F);
      scales_.rest.gain.push_back(0.2F);
      scales_.rest.value.push_back(0.1F * speck + normal(random));
      Distortion distortion;
      for (float& d : distortion.reshaped()) {
        d = normal(random);
      }
      scales_.distortions.push_back(distortion);
      right_.push_back(100.0F + speck + 3.0F * normal(random));
      wrong_.push_back(100.0F + 3.0F * normal(random));
    }
  }

  SampleScales scales_;
  std::vector<float> right_, wrong_;
};

TEST_F(PlaceScorerTest, StrongDifferencesTellMoreThanAll) {
  const PlaceScore all = PlaceScorer(scales_, 1e-3).ScoreOf(right_, 0.0);
  const PlaceScore strong = PlaceScorer(scales_, 10.0).ScoreOf(right_, 0.0);
  EXPECT_GT(strong.score, 1.2 * all.score);
  EXPECT_LT(strong.expected, all.expected);
  EXPECT_GT(strong.score / strong.expected, 0.3);
}

TEST_F(PlaceScorerTest, AWrongPlaceScoresByChance) {
  EXPECT_LT(std::abs(PlaceScorer(scales_, 5.0).ScoreOf(wrong_, 0.0).score), 3.0);
}

TEST_F(PlaceScorerTest, WhatIsNotSurveyedDoesNotCount) {
  std::vector<float> half = right_;
  for (std::size_t i = 0; i < kSamples / 2; ++i) {
    half[i] = std::numeric_limits<float>::quiet_NaN();
  }
  const PlaceScorer scorer(scales_, 5.0);
  EXPECT_LT(scorer.ScoreOf(half, 0.0).expected, 0.8 * scorer.ScoreOf(right_, 0.0).expected);
  EXPECT_GT(scorer.ScoreOf(half, 0.0).score, 0.5 * scorer.ScoreOf(right_, 0.0).score);
}

// A shift of the view that the rest shows is no sign of the place whose difference looks like it.
TEST_F(PlaceScorerTest, DistortionsAreNoDifference) {
  for (std::size_t i = 0; i < kSamples; ++i) {
    scales_.rest.value[i] = 0.2F * 5.0F * scales_.distortions[i](0);
    right_[i] = 100.0F + 5.0F * scales_.distortions[i](0);
  }
  EXPECT_LT(std::abs(PlaceScorer(scales_, 1e-3).ScoreOf(right_, 0.0).score), 1.0);
}

// A place in the mean of ten scores as one that the mean is not of.
TEST_F(PlaceScorerTest, APlaceIsComparedWithTheMeanOfTheOthers) {
  const PlaceScore expected = PlaceScorer(scales_, 5.0).ScoreOf(right_, 0.0);
  constexpr float kShare = 0.1F;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const float move = kShare * (right_[i] - scales_.mean[i]);
    scales_.mean[i] += move;
    scales_.rest.value[i] -= scales_.rest.gain[i] * move;
  }
  const PlaceScorer scorer(scales_, 5.0);
  EXPECT_NEAR(scorer.ScoreOf(right_, kShare).score, expected.score, 1e-3);
  EXPECT_NEAR(scorer.ScoreOf(right_, kShare).expected, expected.expected, 1e-3);
  EXPECT_GT(std::abs(scorer.ScoreOf(right_, 0.0).score - expected.score), 0.1);
}

}  // namespace
}  // namespace floorloc
