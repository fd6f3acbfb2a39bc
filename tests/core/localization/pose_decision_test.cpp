// SPDX-License-Identifier: Apache-2.0
#include "core/localization/pose_decision.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>

namespace floorloc {
namespace {

constexpr float kMaxDistance = 60.0F;
constexpr int kKeypoints = 120;
constexpr int kCells = kKeypoints / 2;  // as many as keypoints with an inlier
constexpr int kSupport = 20;
constexpr double kStrongVotes = -30.0;

// Poses of one frame at different x. By default each is highly significant by its keypoints, has votes, and has inliers
// of similar distance at every other keypoint.
class PoseDecisionTest : public ::testing::Test {
 protected:
  VerifiedPose MakePose(double x) {
    VerifiedPose pose;
    pose.candidate.target_from_source = Pose2(x, 0.0, 0.0);
    pose.candidate.inliers.resize(kKeypoints / 2);
    std::iota(pose.candidate.inliers.begin(), pose.candidate.inliers.end(), 0);
    pose.candidate.log10_nfa = -40.0;
    for (int i = 0; i < kSupport; ++i) {
      pose.supporting_keypoints.push_back(2 * i);
    }
    pose.support_log10_nfa = kStrongVotes;
    for (int i = 0; i < kKeypoints; ++i) {
      pose.distance.push_back(i % 2 == 0 ? Uniform(20.0F, 40.0F) : std::numeric_limits<float>::infinity());
    }
    return pose;
  }
  static VerifiedPose WithoutVotes(VerifiedPose pose) {
    pose.supporting_keypoints.clear();
    pose.support_log10_nfa = 0.0;
    return pose;
  }
  // With smaller descriptor distances.
  static VerifiedPose WithNearerKeypoints(VerifiedPose pose, float nearer) {
    for (float& distance : pose.distance) {
      distance -= nearer;
    }
    return pose;
  }
  VerifiedPose WithImage(VerifiedPose pose, float correlation) {
    PhotometricFit fit;
    for (int c = 0; c < kCells; ++c) {
      fit.cell_correlation.push_back(correlation + Uniform(-0.1F, 0.1F));
      fit.cell_samples.push_back(64);
    }
    pose.photo = fit;
    return pose;
  }
  // Without mosaic in the cells from first_cell on, as beyond the map's edge.
  static VerifiedPose WithoutFloorFrom(VerifiedPose pose, std::size_t first_cell) {
    for (std::size_t c = first_cell; c < kCells; ++c) {
      pose.photo->cell_correlation[c] = 0.0F;
      pose.photo->cell_samples[c] = 0;
    }
    return pose;
  }
  // Surveyed floor in two thirds of the frame only: not in third `missing`.
  VerifiedPose WithoutThird(std::size_t missing) {
    VerifiedPose pose = WithImage(MakePose(static_cast<double>(missing)), 0.5F);
    pose.supporting_keypoints.clear();
    pose.distance.assign(kKeypoints, 30.0F);
    pose.photo->cell_correlation.assign(kCells, 0.5F);
    std::fill_n(pose.photo->cell_samples.begin() + static_cast<std::ptrdiff_t>(missing) * kCells / 3, kCells / 3, 0);
    return pose;
  }
  // Of a third's 40 keypoints so many resemble the map less than usual, the others more.
  static void Worsen(std::size_t third, int worse, VerifiedPose* pose) {
    for (int i = 0; i < kKeypoints / 3; ++i) {
      pose->distance[third * kKeypoints / 3 + static_cast<std::size_t>(i)] += i < worse ? 5.0F : -5.0F;
    }
  }
  static PoseDecision Decide(const std::vector<VerifiedPose>& poses, bool floor_repeats = true) {
    return Decide(poses, PoseEvidence{kMaxDistance, {}, floor_repeats});
  }
  static PoseDecision DecideOnLattice(const std::vector<VerifiedPose>& poses, const LatticeComparison& lattice) {
    return Decide(poses, PoseEvidence{kMaxDistance, {}, true, &lattice});
  }
  // Of equal likelihood, at different x.
  static LatticeComparison PlacesAt(const std::vector<double>& x) {
    LatticeComparison lattice;
    lattice.tolerance_m = 0.1;
    for (const double each : x) {
      lattice.places.push_back({Eigen::Vector2i::Zero(), Pose2(each, 0.0, 0.0)});
    }
    return lattice;
  }

 private:
  static PoseDecision Decide(const std::vector<VerifiedPose>& poses, PoseEvidence evidence) {
    for (int i = 0; i < kKeypoints; ++i) {
      evidence.cell_of_keypoint.push_back(i / 2);
    }
    return DecidePose(poses, evidence, RegistrationOptions(), DecisionOptions());
  }
  float Uniform(float low, float high) { return std::uniform_real_distribution<float>(low, high)(rng_); }
  std::mt19937 rng_{13};
};

void ExpectAccepted(const PoseDecision& decision, int best) {
  EXPECT_EQ(decision.status, RegistrationStatus::kRegistered);
  EXPECT_EQ(decision.best, best);
  EXPECT_LT(decision.p_wrong, RegistrationOptions().max_p_wrong);
  EXPECT_TRUE(decision.alternatives.empty());
}

// Weights are normalised over all hypotheses, the best one first.
void ExpectAmbiguous(const PoseDecision& decision, std::size_t alternatives) {
  EXPECT_EQ(decision.status, RegistrationStatus::kAmbiguous);
  ASSERT_EQ(decision.alternatives.size(), alternatives);
  double sum = 0.0;
  for (const PoseHypothesis& hypothesis : decision.alternatives) {
    EXPECT_LE(hypothesis.weight, decision.alternatives.front().weight);
    EXPECT_EQ(hypothesis.inliers, kKeypoints / 2);
    sum += hypothesis.weight;
  }
  EXPECT_NEAR(sum, 1.0, 1e-3);
  EXPECT_NEAR(decision.p_wrong, 1.0 - decision.alternatives.front().weight, 1e-3);
}

TEST_F(PoseDecisionTest, WithoutPosesThereIsNoBest) {
  const PoseDecision decision = Decide({});
  EXPECT_EQ(decision.status, RegistrationStatus::kTooFewInliers);
  EXPECT_EQ(decision.best, -1);
  EXPECT_EQ(decision.p_wrong, 1.0);
}

TEST_F(PoseDecisionTest, ALonePoseBeyondChanceIsAccepted) { ExpectAccepted(Decide({MakePose(0.0)}), 0); }

TEST_F(PoseDecisionTest, TooFewInliersAreNoPose) {
  VerifiedPose pose = MakePose(0.0);
  pose.candidate.inliers.resize(static_cast<std::size_t>(RegistrationOptions().min_inliers) - 1);
  const PoseDecision decision = Decide({pose});
  EXPECT_EQ(decision.status, RegistrationStatus::kTooFewInliers);
  EXPECT_EQ(decision.best, -1);
}

TEST_F(PoseDecisionTest, KeypointsThatChanceExplainsAreNotSignificant) {
  VerifiedPose pose = WithImage(MakePose(0.0), 0.9F);
  pose.candidate.log10_nfa = -2.0;
  const PoseDecision decision = Decide({pose}, false);
  EXPECT_EQ(decision.status, RegistrationStatus::kNotSignificant);
  EXPECT_EQ(decision.best, 0);
  EXPECT_NEAR(decision.p_wrong, 0.01, 1e-6);
}

TEST_F(PoseDecisionTest, EqualPosesAreAmbiguous) {
  ExpectAmbiguous(Decide({MakePose(0.0), MakePose(1.0)}), 2);
  ExpectAmbiguous(Decide({MakePose(0.0), MakePose(1.0), MakePose(2.0)}), 3);
}

TEST_F(PoseDecisionTest, IdenticalPosesShareEvenly) {
  const VerifiedPose pose = WithImage(MakePose(0.0), 0.5F);
  for (std::size_t k = 2; k <= 10; ++k) {
    const PoseDecision decision = Decide(std::vector<VerifiedPose>(k, pose));
    const double share = 1.0 / static_cast<double>(k);
    ASSERT_EQ(decision.alternatives.size(), k);
    for (const PoseHypothesis& hypothesis : decision.alternatives) {
      EXPECT_NEAR(hypothesis.weight, share, 1e-9) << k;
    }
    EXPECT_NEAR(decision.p_wrong, 1.0 - share, 1e-4) << k;
  }
}

// Poses of different quality, some hard to distinguish.
TEST_F(PoseDecisionTest, TheOrderOfThePosesDoesNotMatter) {
  std::vector<VerifiedPose> poses;
  for (int i = 0; i < 6; ++i) {
    const float merit = static_cast<float>(i % 3);
    poses.push_back(WithImage(WithNearerKeypoints(MakePose(i), 1.5F * merit), 0.3F + 0.02F * merit));
  }
  const PoseDecision first = Decide(poses);
  const double best_x = poses[static_cast<std::size_t>(first.best)].candidate.target_from_source.x();
  std::mt19937 random(3);
  for (int trial = 0; trial < 50; ++trial) {
    std::shuffle(poses.begin(), poses.end(), random);
    const PoseDecision again = Decide(poses);
    EXPECT_EQ(again.status, first.status);
    EXPECT_EQ(poses[static_cast<std::size_t>(again.best)].candidate.target_from_source.x(), best_x);
    EXPECT_NEAR(again.p_wrong, first.p_wrong, 1e-9);
    EXPECT_EQ(again.alternatives.size(), first.alternatives.size());
  }
}

// Each pair is compared in another third of the frame: the first clearly beats the second, which beats the third, which
// beats the first, both by a little.
TEST_F(PoseDecisionTest, TheOrderDoesNotMatterWhereComparisonsGoInACircle) {
  std::vector<VerifiedPose> poses{WithoutThird(0), WithoutThird(1), WithoutThird(2)};
  Worsen(2, 40, &poses[1]);
  Worsen(0, 22, &poses[2]);
  Worsen(1, 21, &poses[0]);
  const PoseDecision first = Decide(poses);
  EXPECT_EQ(first.best, 0);
  for (int turn = 0; turn < 3; ++turn) {
    for (const bool swapped : {false, true}) {
      std::rotate(poses.begin(), poses.begin() + 1, poses.end());
      std::vector<VerifiedPose> ordered = poses;
      if (swapped) {
        std::swap(ordered[0], ordered[1]);
      }
      const PoseDecision again = Decide(ordered);
      EXPECT_EQ(ordered[static_cast<std::size_t>(again.best)].candidate.target_from_source.x(), 0.0);
      EXPECT_NEAR(again.p_wrong, first.p_wrong, 1e-9);
    }
  }
}

TEST_F(PoseDecisionTest, AHopelessRivalChangesNothing) {
  const std::vector<VerifiedPose> poses{MakePose(0.0), MakePose(1.0)};
  const PoseDecision without = Decide(poses);
  VerifiedPose hopeless = WithoutVotes(MakePose(2.0));
  hopeless.distance.assign(kKeypoints, std::numeric_limits<float>::infinity());
  const PoseDecision with = Decide({poses[0], poses[1], hopeless});
  EXPECT_EQ(with.best, without.best);
  EXPECT_NEAR(with.p_wrong, without.p_wrong, 1e-6);
  EXPECT_EQ(with.alternatives.size(), without.alternatives.size());
  ExpectAccepted(Decide({poses[0], hopeless}), 0);
  ExpectAccepted(Decide({hopeless, poses[0]}), 1);
}

TEST_F(PoseDecisionTest, APoseExplainedByChanceIsNoRival) {
  VerifiedPose chance = MakePose(1.0);
  chance.candidate.log10_nfa = -0.5;
  ExpectAccepted(Decide({MakePose(0.0), chance}), 0);
}

TEST_F(PoseDecisionTest, NearerKeypointsDecide) {
  const VerifiedPose pose = MakePose(0.0);
  const VerifiedPose nearer = WithNearerKeypoints(MakePose(1.0), 15.0F);
  ExpectAccepted(Decide({pose, nearer}), 1);
  ExpectAccepted(Decide({nearer, pose}), 0);
}

TEST_F(PoseDecisionTest, AClearlyBetterImageScoreDecidesBetweenEqualKeypoints) {
  const VerifiedPose right = WithImage(MakePose(0.0), 0.6F);
  const VerifiedPose wrong = WithImage(MakePose(1.0), 0.2F);
  ExpectAccepted(Decide({right, wrong}), 0);
  ExpectAccepted(Decide({wrong, right}), 1);
}

TEST_F(PoseDecisionTest, EqualImageScoresAreAmbiguous) {
  ExpectAmbiguous(Decide({WithImage(MakePose(0.0), 0.5F), WithImage(MakePose(1.0), 0.5F)}), 2);
}

TEST_F(PoseDecisionTest, AnInconclusiveImageDoesNotWeakenTheKeypoints) {
  const VerifiedPose pose = WithImage(MakePose(0.0), 0.5F);
  VerifiedPose nearer = WithNearerKeypoints(MakePose(1.0), 15.0F);
  nearer.photo = pose.photo;
  ExpectAccepted(Decide({pose, nearer}), 1);
}

TEST_F(PoseDecisionTest, ContradictingKeypointsAndImageAreAmbiguous) {
  const VerifiedPose pose = WithImage(MakePose(0.0), 0.2F);
  VerifiedPose by_image = WithImage(pose, 0.6F);
  by_image.candidate.target_from_source = Pose2(1.0, 0.0, 0.0);
  const VerifiedPose by_keypoints = WithNearerKeypoints(pose, 15.0F);
  ExpectAccepted(Decide({pose, by_image}), 1);
  ExpectAccepted(Decide({pose, by_keypoints}), 1);
  ExpectAmbiguous(Decide({by_image, by_keypoints}), 2);
  ExpectAmbiguous(Decide({by_keypoints, by_image}), 2);
}

TEST_F(PoseDecisionTest, OneImageAloneComparesNothing) {
  ExpectAmbiguous(Decide({WithImage(MakePose(0.0), 0.9F), MakePose(1.0)}), 2);
}

// Among several wrong poses one always has the best score.
TEST_F(PoseDecisionTest, WithoutVotesABetterImageScoreIsNotEnough) {
  std::vector<VerifiedPose> poses;
  for (const double x : {0.0, 1.0, 2.0}) {
    poses.push_back(WithImage(WithoutVotes(MakePose(x)), 0.1F));
  }
  poses.push_back(WithImage(WithoutVotes(MakePose(3.0)), 0.6F));
  const PoseDecision decision = Decide(poses);
  EXPECT_EQ(decision.status, RegistrationStatus::kNotSignificant);
  EXPECT_EQ(decision.best, 3);
}

TEST_F(PoseDecisionTest, OnANonRepetitiveFloorAnAgreeingImageIsDistinctive) {
  const VerifiedPose agrees = WithImage(WithoutVotes(MakePose(0.0)), 0.6F);
  ExpectAccepted(Decide({agrees}, false), 0);
  EXPECT_EQ(Decide({agrees}, true).status, RegistrationStatus::kNotSignificant);
  EXPECT_EQ(Decide({WithImage(WithoutVotes(MakePose(0.0)), 0.03F)}, false).status, RegistrationStatus::kNotSignificant);
}

TEST_F(PoseDecisionTest, OnARepetitiveFloorFewInliersMayBeAliased) {
  VerifiedPose few = MakePose(0.0);
  few.candidate.inliers.resize(20);
  ExpectAccepted(Decide({few}, false), 0);
  EXPECT_EQ(Decide({few}, true).status, RegistrationStatus::kAmbiguous);
  EXPECT_GT(Decide({few}, true).p_wrong, 1e-4);
}

// Upright descriptors give a similar place many inliers; whether the right one would have been found is told by those
// at the keypoints' own angles.
TEST_F(PoseDecisionTest, OnARepetitiveFloorFewOwnAngleInliersMayBeAliased) {
  VerifiedPose pose = MakePose(0.0);
  ExpectAccepted(Decide({pose}), 0);
  pose.own_angle_inliers = 30;
  const PoseDecision decision = Decide({pose});
  EXPECT_NE(decision.status, RegistrationStatus::kRegistered);
  EXPECT_GT(decision.p_wrong, 1e-4);
  ExpectAccepted(Decide({pose}, false), 0);
}

// All places of the lattice were compared: no other was missed, and what the pixels say of them decides.
TEST_F(PoseDecisionTest, OnALatticeThePlacesDecide) {
  VerifiedPose right = WithoutVotes(MakePose(0.0));
  right.own_angle_inliers = 30;
  VerifiedPose other = MakePose(1.0);
  LatticeComparison lattice = PlacesAt({0.0, 1.0, 2.0});
  EXPECT_NE(DecideOnLattice({right, other}, lattice).status, RegistrationStatus::kRegistered);
  lattice.places[0].log_likelihood = 30.0;
  ExpectAccepted(DecideOnLattice({other, right}, lattice), 1);
  lattice.places[1].log_likelihood = 27.0;
  ExpectAmbiguous(DecideOnLattice({right, other}, lattice), 2);
}

TEST_F(PoseDecisionTest, ALikelyPlaceThatIsNoPoseMakesTheBestAmbiguous) {
  const VerifiedPose pose = MakePose(0.0);
  LatticeComparison lattice = PlacesAt({0.0, 1.0});
  lattice.places[0].log_likelihood = 30.0;
  ExpectAccepted(DecideOnLattice({pose}, lattice), 0);
  lattice.places[1].log_likelihood = 25.0;
  EXPECT_EQ(DecideOnLattice({pose}, lattice).status, RegistrationStatus::kAmbiguous);
  lattice.places[1].prior_weight = 1e-4;  // outside the prior
  ExpectAccepted(DecideOnLattice({pose}, lattice), 0);
}

TEST_F(PoseDecisionTest, PlacesThatWereNotComparedCount) {
  const VerifiedPose pose = MakePose(0.0);
  LatticeComparison lattice = PlacesAt({0.0, 1.0});
  lattice.places[0].log_likelihood = 12.0;
  ExpectAccepted(DecideOnLattice({pose}, lattice), 0);
  lattice.not_compared = 1000.0;
  EXPECT_EQ(DecideOnLattice({pose}, lattice).status, RegistrationStatus::kAmbiguous);
  lattice.prior_weight_elsewhere = 1e-4;
  ExpectAccepted(DecideOnLattice({pose}, lattice), 0);
}

TEST_F(PoseDecisionTest, APoseOffTheLatticeIsDecidedAsWithoutOne) {
  VerifiedPose pose = MakePose(0.5);
  LatticeComparison lattice = PlacesAt({0.0, 1.0});
  lattice.places[0].log_likelihood = 30.0;
  ExpectAccepted(DecideOnLattice({pose}, lattice), 0);
  pose.own_angle_inliers = 30;
  EXPECT_NE(DecideOnLattice({pose}, lattice).status, RegistrationStatus::kRegistered);
}

TEST_F(PoseDecisionTest, FloorOutsideTheMapIsExcluded) {
  const VerifiedPose inside = WithImage(MakePose(0.0), 0.5F);
  VerifiedPose at_edge = WithImage(MakePose(1.0), 0.5F);
  at_edge.distance = inside.distance;
  for (std::size_t i = kKeypoints / 2; i < kKeypoints; ++i) {
    at_edge.distance[i] = std::numeric_limits<float>::infinity();
  }
  std::erase_if(at_edge.supporting_keypoints, [](int keypoint) { return keypoint >= kKeypoints / 2; });
  EXPECT_EQ(Decide({inside, at_edge}).best, 0);  // all of the image is compared, and half of it has no match
  ExpectAmbiguous(Decide({inside, WithoutFloorFrom(at_edge, kCells / 2)}), 2);
}

TEST_F(PoseDecisionTest, APlaceOutsideThePriorMustBeClearlyBetter) {
  const VerifiedPose inside = MakePose(0.0);
  VerifiedPose outside = MakePose(1.0);
  outside.prior_weight = 1e-6;
  ExpectAccepted(Decide({outside, inside}), 1);
  ExpectAccepted(Decide({inside, WithNearerKeypoints(outside, 20.0F)}), 1);
}

TEST_F(PoseDecisionTest, AViewThatAgreesInOnePartOnlyIsNoFix) {
  VerifiedPose part = MakePose(0.0);
  part.view = ViewSupport{0.13, -2.5};
  const PoseDecision decision = Decide({part}, false);
  EXPECT_EQ(decision.status, RegistrationStatus::kViewDisagrees);
  EXPECT_GT(decision.p_wrong, 0.99);
  part.view = ViewSupport{0.9, 50.0};
  ExpectAccepted(Decide({part}, false), 0);
}

TEST_F(PoseDecisionTest, TheRestOfTheViewDecidesBetweenAPartAndTheFloor) {
  const VerifiedPose floor = WithImage(MakePose(0.0), 0.5F);
  VerifiedPose part = floor;
  part.candidate.target_from_source = Pose2(1.0, 0.0, 0.0);
  for (std::size_t i = 0; i < kKeypoints / 2; ++i) {
    part.distance[i] -= 10.0F;
  }
  ExpectAccepted(Decide({floor, part}, false), 1);
  VerifiedPose seen = floor;
  seen.view = ViewSupport{0.7, 40.0};
  part.view = ViewSupport{0.3, -6.0};
  ExpectAccepted(Decide({seen, part}, false), 0);
  ExpectAccepted(Decide({part, seen}, false), 1);
}

TEST_F(PoseDecisionTest, WithoutVotesOrImageScoresNothingIsDistinctive) {
  EXPECT_EQ(Decide({WithoutVotes(MakePose(0.0))}).status, RegistrationStatus::kNotSignificant);
}

}  // namespace
}  // namespace floorloc
