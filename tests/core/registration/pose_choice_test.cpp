// SPDX-License-Identifier: Apache-2.0
#include "core/registration/pose_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "tests/core/registration/registration_test_support.h"

namespace floorloc {
namespace {

using testing_registration::Join;
using testing_registration::MatchGenerator;

constexpr double kCertain = 1e-12;  // no false alarm

// Pose i is at x = i.
PoseContest Contest(const std::vector<double>& odds, std::size_t best = 0) {
  PoseContest contest;
  for (std::size_t i = 0; i < odds.size(); ++i) {
    contest.hypotheses.push_back({Pose2(static_cast<double>(i), 0.0, 0.0), 40, odds[i]});
  }
  contest.best = best;
  contest.p_chance = kCertain;
  return contest;
}

PoseDecision Choose(const PoseContest& contest) { return ChoosePose(contest, RegistrationOptions()); }

double SumOfWeights(const PoseDecision& decision) {
  return std::accumulate(decision.alternatives.begin(), decision.alternatives.end(), 0.0,
                         [](double sum, const PoseHypothesis& h) { return sum + h.weight; });
}

TEST(PoseChoiceTest, EqualPosesShareEvenly) {
  for (std::size_t k = 2; k <= 12; ++k) {
    const PoseDecision decision = Choose(Contest(std::vector<double>(k, 1.0)));
    const double share = 1.0 / static_cast<double>(k);
    EXPECT_EQ(decision.status, RegistrationStatus::kAmbiguous);
    EXPECT_NEAR(decision.p_wrong, 1.0 - share, 1e-9) << k;
    ASSERT_EQ(decision.alternatives.size(), k);
    for (const PoseHypothesis& hypothesis : decision.alternatives) {
      EXPECT_NEAR(hypothesis.weight, share, 1e-12) << k;
    }
  }
}

TEST(PoseChoiceTest, WeightsAreTheOddsOverTheirSum) {
  const PoseDecision decision = Choose(Contest({1.0, 0.5, 0.25, 0.25}));
  ASSERT_EQ(decision.alternatives.size(), 4U);
  EXPECT_NEAR(decision.alternatives[0].weight, 0.5, 1e-12);
  EXPECT_NEAR(decision.alternatives[1].weight, 0.25, 1e-12);
  EXPECT_NEAR(decision.alternatives[2].weight, 0.125, 1e-12);
}

TEST(PoseChoiceTest, TheOrderOfThePosesDoesNotMatter) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> decades(-6.0, 0.0);
  for (int trial = 0; trial < 100; ++trial) {
    PoseContest contest = Contest({1.0, std::pow(10.0, decades(random)), std::pow(10.0, decades(random))});
    const PoseDecision first = Choose(contest);
    std::swap(contest.hypotheses[0], contest.hypotheses[2]);
    contest.best = 2;
    const PoseDecision second = Choose(contest);
    EXPECT_EQ(first.status, second.status);
    EXPECT_EQ(second.best, 2);
    EXPECT_NEAR(first.p_wrong, second.p_wrong, 1e-15);
    EXPECT_NEAR(SumOfWeights(first), SumOfWeights(second), 1e-12);
  }
}

TEST(PoseChoiceTest, TheSumOfTheWeightsIsAtMostOne) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> decades(-8.0, 0.0);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> odds{1.0};
    for (int i = 0; i < trial % 20; ++i) {
      odds.push_back(std::pow(10.0, decades(random)));
    }
    const PoseDecision decision = Choose(Contest(odds));
    EXPECT_LE(SumOfWeights(decision), 1.0 + 1e-12);
    EXPECT_LE(decision.p_wrong, 1.0);
  }
}

TEST(PoseChoiceTest, AHopelessRivalChangesNothing) {
  for (const std::vector<double>& odds : {std::vector<double>{1.0}, {1.0, 0.7}, {1.0, 1e-5}}) {
    std::vector<double> with_hopeless = odds;
    with_hopeless.push_back(0.0);
    const PoseDecision without = Choose(Contest(odds));
    const PoseDecision with = Choose(Contest(with_hopeless));
    EXPECT_EQ(with.status, without.status);
    EXPECT_EQ(with.p_wrong, without.p_wrong);
    EXPECT_EQ(with.alternatives.size(), without.alternatives.size());
    EXPECT_EQ(SumOfWeights(with), SumOfWeights(without));
  }
}

TEST(PoseChoiceTest, ChanceAndAMissedPoseAddToTheRisk) {
  PoseContest contest = Contest({1.0, 1e-5});
  contest.p_chance = 2e-5;
  contest.p_missed = 3e-5;
  const PoseDecision decision = Choose(contest);
  EXPECT_EQ(decision.status, RegistrationStatus::kRegistered);
  EXPECT_NEAR(decision.p_wrong, 6e-5, 1e-9);
  contest.p_missed = 3e-4;
  EXPECT_EQ(Choose(contest).status, RegistrationStatus::kAmbiguous);
  contest.p_chance = 2e-4;
  EXPECT_EQ(Choose(contest).status, RegistrationStatus::kNotSignificant);
}

TEST(PoseChoiceTest, APoseOfAPartOfTheViewIsNotAccepted) {
  PoseContest contest = Contest({1.0, 1e-5});
  contest.p_local = 5e-5;
  EXPECT_EQ(Choose(contest).status, RegistrationStatus::kRegistered);
  EXPECT_NEAR(Choose(contest).p_wrong, 6e-5, 1e-9);
  contest.p_local = 0.99;
  EXPECT_EQ(Choose(contest).status, RegistrationStatus::kViewDisagrees);
  EXPECT_GT(Choose(contest).p_wrong, 0.98);
}

TEST(PoseChoiceTest, NoModelIsSurerOfItself) {
  EXPECT_EQ(Choose(Contest({1.0})).p_wrong, RegistrationOptions().min_p_wrong);
}

TEST(PoseChoiceTest, WithoutEnoughInliersThereIsNoBest) {
  EXPECT_EQ(Choose({}).best, -1);
  PoseContest contest = Contest({1.0});
  contest.hypotheses[0].inliers = RegistrationOptions().min_inliers - 1;
  EXPECT_EQ(Choose(contest).best, -1);
  EXPECT_EQ(Choose(contest).status, RegistrationStatus::kTooFewInliers);
}

// The same must hold for the odds from registration.
TEST(PoseChoiceTest, ThreeEqualMotionsHaveAThirdEach) {
  MatchGenerator draw(21);
  const Pose2 one(0.3, 0.2, 0.5);
  const auto matches = Join(Join(draw.Right(40, one, 0.0), draw.Right(40, one * Pose2(1.0, 0.0, 1.0), 0.0)),
                            draw.Right(40, one * Pose2(0.0, 1.0, -1.0), 0.0));
  const RegistrationResult result = RegisterSe2(matches, {24.0}, RegistrationOptions());
  ASSERT_EQ(result.status, RegistrationStatus::kAmbiguous);
  ASSERT_EQ(result.alternatives.size(), 3U);
  for (const PoseHypothesis& hypothesis : result.alternatives) {
    EXPECT_NEAR(hypothesis.weight, 1.0 / 3.0, 1e-9);
  }
}

}  // namespace
}  // namespace floorloc
