// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/lattice_tracker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/option_test_support.h"

namespace floorloc {
namespace {

constexpr double kPeriodM = 0.3;
constexpr double kSideM = 6.0;
constexpr double kExpected = 4.0;  // score at the right place, if nothing were worn
constexpr double kViewM2 = 0.2;

// A vehicle that drives over tiles. Its frames show some other tile as well as its own one.
class TiledDrive {
 public:
  explicit TiledDrive(const Pose2& start, unsigned seed = 1) : truth(start), random_(seed) {}

  Pose2 truth;

  /// Moves the vehicle; returns what its wheels say.
  Pose2 Drive(double metres, double turn_rad) {
    const Pose2 motion(metres, 0.0, turn_rad);
    truth = truth * motion;
    return Pose2(metres * (1.0 + 0.01 * normal_(random_)), 0.002 * normal_(random_),
                 turn_rad + 0.003 * normal_(random_));
  }

  /// gain: of the score at the right place, as a share of the expected one; 0: the floor shows no differences.
  LatticeObservation See(double gain) {
    LatticeObservation seen;
    seen.lattice.basis = kPeriodM * Eigen::Matrix2d::Identity();
    seen.map_extent = {0.0, kSideM, 0.0, kSideM};
    seen.covariance = Eigen::Vector3d(1e-7, 1e-7, 1e-7).asDiagonal();
    seen.p_wrong = 1e-7;
    seen.view_area_m2 = kViewM2;
    std::uniform_int_distribution<int> far(-3, 3);
    const Eigen::Vector2i shown(far(random_), far(random_));
    const auto at = [&](const Eigen::Vector2i& multiples) {
      return Pose2(truth.x() + kPeriodM * multiples.x(), truth.y() + kPeriodM * multiples.y(), truth.yaw());
    };
    seen.map_from_base = at(shown);
    const int side = static_cast<int>(kSideM / kPeriodM);
    for (int i = -side; i <= side; ++i) {
      for (int k = -side; k <= side; ++k) {
        LatticePlace place;
        place.multiples = Eigen::Vector2i(i, k) - shown;
        place.map_from_base = at({i, k});
        place.expected_sigma = kExpected;
        place.sigma = normal_(random_) + (i == 0 && k == 0 ? gain * kExpected : 0.0);
        if (seen.map_extent.Contains(place.map_from_base.translation())) {
          seen.places.push_back(place);
        }
      }
    }
    return seen;
  }

 private:
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
};

double Distance(const Pose2& a, const Pose2& b) { return (a.translation() - b.translation()).norm(); }

TEST(LatticeTrackerTest, DrivingTellsThePlace) {
  TiledDrive drive(Pose2(2.03, 3.11, 0.4));
  LatticeTracker tracker;
  int frames = 0;
  std::optional<LatticeFix> fix = tracker.Add(drive.See(0.6));
  EXPECT_FALSE(fix);
  EXPECT_GT(*tracker.PElsewhere(), 0.5);
  while (!fix && ++frames < 40) {
    tracker.Move(drive.Drive(0.25, 0.25));
    fix = tracker.Add(drive.See(0.6));
  }
  ASSERT_TRUE(fix);
  EXPECT_GT(frames, 3);
  EXPECT_LT(Distance(fix->map_from_base, drive.truth), 1e-6);
  EXPECT_LT(fix->p_wrong, 1e-4);
  EXPECT_EQ(tracker.Hypotheses().size(), 1U);
}

TEST(LatticeTrackerTest, AFloorWithoutDifferencesStaysAmbiguous) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    TiledDrive drive(Pose2(3.0, 2.0, 0.0), seed);
    LatticeTracker tracker;
    tracker.Add(drive.See(0.0));
    for (int i = 0; i < 60; ++i) {  // a circle of 0.5 m far from the border
      tracker.Move(drive.Drive(0.2, 0.4));
      EXPECT_FALSE(tracker.Add(drive.See(0.0)));
    }
    EXPECT_GT(*tracker.PElsewhere(), 0.5);
  }
}

TEST(LatticeTrackerTest, StandingStillTellsNothingNew) {
  TiledDrive drive(Pose2(2.0, 3.0, 0.4));
  LatticeTracker tracker;
  for (int i = 0; i < 100; ++i) {
    EXPECT_FALSE(tracker.Add(drive.See(0.3)));
    tracker.Move(Pose2());
  }
}

TEST(LatticeTrackerTest, TheBorderOfTheMapTellsThePlace) {
  TiledDrive drive(Pose2(0.4, 0.4, 0.0));
  LatticeTracker tracker;
  tracker.Add(drive.See(0.0));
  for (int i = 0; i < 100; ++i) {  // once along the border: only there a square of 5.2 m fits into the map
    tracker.Move(drive.Drive(0.2, i % 26 == 25 ? 1.5707963 : 0.0));
    tracker.Add(drive.See(0.0));
  }
  double beside = 1.0;  // probability of places more than two tiles away
  for (const PoseHypothesis& place : tracker.Hypotheses()) {
    beside -= Distance(place.target_from_source, drive.truth) < 2.9 * kPeriodM ? place.weight : 0.0;
  }
  EXPECT_LT(beside, 0.2);
}

TEST(LatticeTrackerTest, AVehicleThatWasMovedStartsAnew) {
  TiledDrive drive(Pose2(2.03, 3.11, 0.4));
  LatticeTracker tracker;
  tracker.AddLocalized(drive.See(0.3), drive.truth, 1e-8);
  ASSERT_LT(*tracker.PElsewhere(), 1e-4);
  drive.truth = Pose2(4.5, 1.34, 2.9);
  tracker.Move(Pose2());
  EXPECT_FALSE(tracker.Add(drive.See(0.3)));
  EXPECT_GT(*tracker.PElsewhere(), 0.5);
}

TEST(LatticeTrackerTest, ASlipByATileIsNoticed) {
  TiledDrive drive(Pose2(2.03, 3.11, 0.4));
  LatticeTracker tracker;
  tracker.AddLocalized(drive.See(0.3), drive.truth, 1e-6);
  drive.truth = Pose2(drive.truth.x() + kPeriodM, drive.truth.y(), drive.truth.yaw());
  std::optional<LatticeFix> fix;
  for (int i = 0; i < 24; ++i) {  // a circle of 2 m
    tracker.Move(drive.Drive(0.25, 0.25));
    fix = tracker.Add(drive.See(1.0));
  }
  ASSERT_TRUE(fix);
  EXPECT_LT(Distance(fix->map_from_base, drive.truth), 1e-6);
}

TEST(LatticeTrackerTest, UnknownMotionStartsAnew) {
  TiledDrive drive(Pose2(2.03, 3.11, 0.4));
  LatticeTracker tracker;
  tracker.AddLocalized(drive.See(0.3), drive.truth, 1e-8);
  tracker.LoseMotion();
  EXPECT_FALSE(tracker.Prior(Pose2(), 4.0));
  EXPECT_FALSE(tracker.Add(drive.See(0.3)));
  EXPECT_GT(*tracker.PElsewhere(), 0.5);
}

TEST(LatticeTrackerTest, ThePriorIsTheLikeliestPlaceAndItsRisk) {
  TiledDrive drive(Pose2(2.03, 3.11, 0.4));
  LatticeTracker tracker;
  EXPECT_FALSE(tracker.Prior(Pose2(), 4.0));
  tracker.AddLocalized(drive.See(0.3), drive.truth, 1e-8);
  const std::optional<PosePrior> prior = tracker.Prior(Pose2(0.2, 0.0, 0.1), 4.0);
  ASSERT_TRUE(prior);
  EXPECT_LT(Distance(prior->map_from_base, drive.truth * Pose2(0.2, 0.0, 0.1)), 1e-6);
  EXPECT_LT(*prior->p_elsewhere, 1e-5);
  EXPECT_FALSE(tracker.Prior(Pose2(5.0, 0.0, 0.0), 4.0));  // by then it may be at a neighbouring place
}

TEST(LatticeTrackerTest, AFrameThatMayBeOnNoPlaceIsNotUsed) {
  TiledDrive drive(Pose2(2.03, 3.11, 0.4));
  LatticeTracker tracker;
  LatticeObservation doubtful = drive.See(0.3);
  doubtful.p_wrong = 0.01;
  EXPECT_FALSE(tracker.Add(doubtful));
  EXPECT_FALSE(tracker.PElsewhere());
}

TEST(LatticeTrackerTest, AFrameByThePriorSaysNothingOfThePlace) {
  TiledDrive drive(Pose2(2.03, 3.11, 0.4));
  LatticeTracker tracker;
  tracker.AddLocalized(drive.See(0.3), drive.truth, 1e-8);
  for (int i = 0; i < 10; ++i) {
    tracker.Move(drive.Drive(0.1, 0.0));
    LatticeObservation seen = drive.See(0.0);
    seen.places.clear();
    seen.by_prior = true;
    const std::optional<LatticeFix> fix = tracker.Add(seen);
    ASSERT_TRUE(fix);
    EXPECT_LT(Distance(fix->map_from_base, drive.truth), 1e-6);
  }
}

TEST(LatticeTrackerTest, BadOptionsAreRefused) {
  using O = LatticeTrackerOptions;
  OptionTable<O>()
      .Refuses("slip_per_m", &O::slip_per_m, {0.0, 1.0})
      .Refuses("gain_sigma", &O::gain_sigma, {0.0})
      .Refuses("sure_p_elsewhere", &O::sure_p_elsewhere, {0.0, 0.1})
      .Refuses("temper", &O::temper, {0.0, 1.1})
      .Refuses("max_p_wrong", &O::max_p_wrong, {0.0, 1.0});
}

}  // namespace
}  // namespace floorloc
