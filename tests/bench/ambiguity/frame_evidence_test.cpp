// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/ambiguity/frame_evidence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

namespace floorloc {
namespace {

// A hall of 3 x 3 m. Of its places, five in a row were compared; all scored 0 but the second one.
LatticeObservation FiveOfHundred(double sigma) {
  LatticeObservation observation;
  observation.lattice.basis = 0.3 * Eigen::Matrix2d::Identity();
  observation.map_extent = {0.0, 3.0, 0.0, 3.0};
  observation.map_from_base = Pose2(1.05, 1.05, 0.0);
  observation.p_wrong = 1e-5;
  for (int i = 0; i < 5; ++i) {
    LatticePlace place;
    place.multiples = {i, 0};
    place.map_from_base = Pose2(1.05 + 0.3 * i, 1.05, 0.0);
    place.sigma = i == 1 ? sigma : 0.0;
    place.expected_sigma = 4.0;
    observation.places.push_back(place);
  }
  return observation;
}

LocalizationResult Ambiguous() {
  LocalizationResult result;
  result.status = LocalizationStatus::kAmbiguous;
  result.alternatives = {{Pose2(1.0, 0.0, 0.0), 9, 0.7}, {Pose2(1.3, 0.0, 0.0), 8, 0.3}};
  return result;
}

TEST(LogLikelihoodOfPlace, IsARatioWhoseMeanAtWrongPlacesIsOne) {
  cv::RNG rng(1);
  constexpr int kDraws = 200000;
  double sum = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    LatticePlace place;
    place.sigma = rng.gaussian(1.0);
    place.expected_sigma = 2.0;
    sum += std::exp(LogLikelihoodOfPlace(place));
  }
  EXPECT_NEAR(sum / kDraws, 1.0, 0.03);
}

TEST(LogLikelihoodOfPlace, OfAPlaceThatDiffersInNothingIsOne) {
  LatticePlace place;
  place.sigma = 3.0;
  EXPECT_NEAR(LogLikelihoodOfPlace(place), 0.0, 1e-12);
}

TEST(BitsOfFrame, CompareTheTruePlaceWithTheMeanOfTheOthers) {
  const LatticeObservation observation = FiveOfHundred(5.0);
  const double right = LogLikelihoodOfPlace(observation.places[1]);
  const double wrong = LogLikelihoodOfPlace(observation.places[0]);
  EXPECT_NEAR(BitsOfFrame(observation, Pose2(1.351, 1.05, 0.0)).value(), (right - wrong) / std::numbers::ln2, 1e-9);
  const double mean = std::log((std::exp(right) + 3.0 * std::exp(wrong)) / 4.0);
  EXPECT_NEAR(BitsOfFrame(observation, Pose2(1.05, 1.05, 0.0)).value(), (wrong - mean) / std::numbers::ln2, 1e-9);
}

TEST(BitsOfFrame, AreNoneWhereTheTruePlaceWasNotCompared) {
  EXPECT_EQ(BitsOfFrame(FiveOfHundred(5.0), Pose2(1.2, 1.05, 0.0)), std::nullopt);
  LatticeObservation none = FiveOfHundred(5.0);
  none.places.clear();
  EXPECT_EQ(BitsOfFrame(none, none.map_from_base), std::nullopt);
}

TEST(EvidenceOf, AFixIsOnePose) {
  LocalizationResult result = Ambiguous();
  result.status = LocalizationStatus::kLocalized;
  result.p_wrong = 1e-5;
  result.lattice = FiveOfHundred(5.0);
  const FrameEvidence evidence = EvidenceOf(result);
  EXPECT_EQ(evidence.poses.size(), 1U);
  EXPECT_NEAR(evidence.log_elsewhere, std::log(1e-5), 1e-9);
}

TEST(EvidenceOf, AllPlacesOfTheMapArePossible) {
  LocalizationResult result = Ambiguous();
  result.lattice = FiveOfHundred(5.0);
  const FrameEvidence evidence = EvidenceOf(result);
  EXPECT_EQ(evidence.poses.size(), 100U);
  const auto likeliest = std::max_element(
      evidence.poses.begin(), evidence.poses.end(),
      [](const PossiblePose& a, const PossiblePose& b) { return a.log_likelihood < b.log_likelihood; });
  EXPECT_NEAR(likeliest->map_from_base.x(), 1.35, 1e-9);
}

TEST(EvidenceOf, OffALatticeAlternativesAreLikelyByTheirWeights) {
  const FrameEvidence evidence = EvidenceOf(Ambiguous());
  ASSERT_EQ(evidence.poses.size(), 2U);
  EXPECT_NEAR(std::exp(evidence.poses[0].log_likelihood - evidence.poses[1].log_likelihood), 0.7 / 0.3, 1e-9);
}

}  // namespace
}  // namespace floorloc
