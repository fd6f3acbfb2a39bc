// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/lattice_weights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace floorloc {
namespace {

std::vector<Eigen::Vector2i> Square(int side) {
  std::vector<Eigen::Vector2i> places;
  for (int i = 0; i < side; ++i) {
    for (int k = 0; k < side; ++k) {
      places.emplace_back(i, k);
    }
  }
  return places;
}

LatticeWeights Fresh(int side = 5) {
  LatticeWeights weights(0.5);
  weights.Start(Square(side), side * side, 1e-3);
  return weights;
}

double ProbabilityAt(const LatticeWeights& weights, const Eigen::Vector2i& at) {
  for (const LatticeWeights::Weight& weight : weights.Listed()) {
    if (weight.at == at) {
      return weight.probability;
    }
  }
  return 0.0;
}

TEST(LatticeWeightsTest, EveryPlaceIsAsLikelyAtFirst) {
  const LatticeWeights weights = Fresh();
  for (const LatticeWeights::Weight& weight : weights.Listed()) {
    EXPECT_NEAR(weight.probability, 0.999 / 25.0, 1e-9);
  }
  EXPECT_NEAR(weights.ProbabilityOfNone(), 1e-3, 1e-9);
}

TEST(LatticeWeightsTest, ScoresAsExpectedTellTheRightPlace) {
  LatticeWeights weights = Fresh();
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int frame = 0; frame < 20; ++frame) {
    for (const Eigen::Vector2i& at : Square(5)) {
      weights.AddScore(at, normal(random) + (at == Eigen::Vector2i(3, 1) ? 1.6 : 0.0), 4.0, 1.0);
    }
  }
  double p_elsewhere = 1.0;
  EXPECT_EQ(weights.Best(&p_elsewhere), Eigen::Vector2i(3, 1));
  EXPECT_LT(p_elsewhere, 1e-4);
}

// However often one looks: of many long drives on a floor without any difference hardly one becomes sure.
TEST(LatticeWeightsTest, ChanceDoesNotMakeAPlaceSure) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  constexpr int kDrives = 200;
  int sure = 0;
  for (int drive = 0; drive < kDrives; ++drive) {
    LatticeWeights weights = Fresh();
    double least = 1.0;
    for (int frame = 0; frame < 100; ++frame) {
      for (const Eigen::Vector2i& at : Square(5)) {
        weights.AddScore(at, normal(random), 4.0, 1.0);
      }
      double p_elsewhere = 1.0;
      weights.Best(&p_elsewhere);
      least = std::min(least, p_elsewhere);
    }
    sure += least < 0.01 ? 1 : 0;
  }
  EXPECT_LE(sure, kDrives / 20);
}

TEST(LatticeWeightsTest, FloorThatWasSeenSaysNothing) {
  LatticeWeights weights = Fresh();
  for (int frame = 0; frame < 100; ++frame) {
    weights.AddScore({2, 2}, 5.0, 4.0, 0.0);
  }
  EXPECT_NEAR(ProbabilityAt(weights, {2, 2}), 0.999 / 25.0, 1e-9);
}

TEST(LatticeWeightsTest, UncertainMotionSpreadsOverNeighbours) {
  LatticeWeights weights = Fresh();
  weights.MultiplyOthers({2, 2}, -20.0);
  weights.Spread(0.0, {{Eigen::Vector2i(1, 0), std::log(0.25)}});
  weights.WeighElsewhere(0.0, 1e-6);
  EXPECT_NEAR(ProbabilityAt(weights, {2, 2}), 0.8, 1e-3);
  EXPECT_NEAR(ProbabilityAt(weights, {3, 2}), 0.2, 1e-3);
  EXPECT_LT(ProbabilityAt(weights, {1, 2}), 1e-3);
}

TEST(LatticeWeightsTest, WhatFitsNoPlaceSpeaksForNone) {
  LatticeWeights weights = Fresh();
  weights.MultiplyOthers({2, 2}, -10.0);
  weights.Spread(-30.0, {});
  weights.WeighElsewhere(0.0, 1e-6);
  EXPECT_GT(weights.ProbabilityOfNone(), 0.99);
}

TEST(LatticeWeightsTest, AShortListKeepsTheProbabilities) {
  LatticeWeights weights = Fresh();
  weights.MultiplyOthers({2, 2}, std::log(1e-9));
  double before = 1.0;
  weights.Best(&before);
  weights.Shorten(1e-6, 1e-15);
  double after = 1.0;
  EXPECT_EQ(weights.Best(&after), Eigen::Vector2i(2, 2));
  EXPECT_EQ(weights.Listed().size(), 1U);
  EXPECT_NEAR(after / before, 1.0, 0.1);
  // Evidence for another place brings it back.
  for (int frame = 0; frame < 40; ++frame) {
    weights.AddScore({2, 2}, 0.0, 4.0, 1.0);
    weights.AddScore({4, 4}, 3.0, 4.0, 1.0);
  }
  EXPECT_EQ(weights.Best(&after), Eigen::Vector2i(4, 4));
}

TEST(LatticeWeightsTest, OnlyASurePlaceMakesAShortList) {
  LatticeWeights weights = Fresh();
  weights.Shorten(1e-6, 1e-15);
  EXPECT_EQ(weights.Listed().size(), 25U);
}

TEST(LatticeWeightsTest, SlipsLeaveSomeProbabilityElsewhere) {
  LatticeWeights weights = Fresh();
  weights.MultiplyOthers({2, 2}, -100.0);
  weights.Slip(0.01);
  EXPECT_NEAR(ProbabilityAt(weights, {0, 0}), 0.01 / 25.0, 1e-5);
}

}  // namespace
}  // namespace floorloc
