// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/planar_odometry.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <vector>

#include "core/vision/extractors/feature_extractor.h"
#include "core/vision/image/rectifier.h"
#include "tests/synthetic/synthetic_floor.h"

namespace floorloc {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::int64_t kStepNs = 50'000'000;

const SyntheticFloor& Floor() {
  static const SyntheticFloor floor(1);
  return floor;
}

const SyntheticFloor& OtherFloor() {
  static const SyntheticFloor floor(2);
  return floor;
}

cv::Mat GrayView(const SyntheticFloor& floor, const Pose2& map_from_base, std::uint64_t noise_seed) {
  RenderConditions conditions;
  conditions.read_noise = 2.0;
  conditions.noise_seed = noise_seed;
  cv::Mat gray;
  cv::cvtColor(floor.View(map_from_base, conditions), gray, cv::COLOR_BGR2GRAY);
  return gray;
}

Features FeaturesOf(const cv::Mat& gray) {
  static const Rectifier rectifier(Floor().camera());
  static const auto extractor = CreateFeatureExtractor({});
  return extractor->Extract(rectifier.Rectify(gray));
}

Features FeaturesAt(const Pose2& map_from_base, std::uint64_t noise_seed) {
  return FeaturesOf(GrayView(Floor(), map_from_base, noise_seed));
}

// One round along an ellipse, heading forward.
std::vector<Pose2> RoundTrip(int steps) {
  std::vector<Pose2> poses;
  for (int i = 0; i <= steps; ++i) {
    const double t = 2.0 * kPi * i / steps;
    poses.push_back(Floor().BaseForView(0.6 + 0.3 * std::cos(t), 0.45 + 0.15 * std::sin(t),
                                        std::atan2(0.15 * std::cos(t), -0.3 * std::sin(t))));
  }
  return poses;
}

PlanarOdometryOptions Options() {
  PlanarOdometryOptions options;
  options.resolution_m = Floor().camera().floor.resolution_m;
  return options;
}

// Options without the errors of vibration and calibration, which the rendered images lack.
PlanarOdometryOptions WithoutSystematicErrors() {
  PlanarOdometryOptions options = Options();
  options.systematic_m = 0.0;
  options.systematic_rad = 0.0;
  return options;
}

double Nees(const Pose2& truth, const Pose2& estimate, const Eigen::Matrix3d& covariance) {
  const Eigen::Vector3d error(estimate.x() - truth.x(), estimate.y() - truth.y(),
                              WrapAngle(estimate.yaw() - truth.yaw()));
  return error.dot(covariance.inverse() * error);
}

TEST(PlanarOdometryTest, FollowsARoundTrip) {
  const std::vector<Pose2> truth = RoundTrip(48);
  PlanarOdometry odometry(Options());
  int keyframes = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const PlanarOdometryResult result = odometry.Track(static_cast<std::int64_t>(i) * kStepNs, FeaturesAt(truth[i], i));
    keyframes += result.new_keyframe ? 1 : 0;
    if (i == 0) {
      EXPECT_EQ(result.status, PlanarOdometryStatus::kFirstFrame);
      continue;
    }
    ASSERT_EQ(result.status, PlanarOdometryStatus::kTracked) << i << " " << ToString(result.loss);
    EXPECT_EQ(result.motion->to_ns - result.motion->from_ns, kStepNs);
    const Pose2 error = truth[i - 1].Between(truth[i]).Between(result.motion->from_from_to);
    EXPECT_LT(error.translation().norm(), 1e-3) << i;
    EXPECT_LT(std::abs(error.yaw()), 0.2 * kPi / 180.0) << i;
    const Pose2 drift = truth[0].Between(truth[i]).Between(result.odom_from_base);
    EXPECT_LT(drift.translation().norm(), 5e-3) << i;
    EXPECT_EQ(result.chain, 0);
  }
  EXPECT_GT(keyframes, 5);
  EXPECT_LT(keyframes, 40);
}

TEST(PlanarOdometryTest, MotionsInARowAreThePose) {
  const std::vector<Pose2> truth = RoundTrip(48);
  PlanarOdometry odometry(Options());
  Pose2 row;
  for (std::size_t i = 0; i < 12; ++i) {
    const PlanarOdometryResult result = odometry.Track(static_cast<std::int64_t>(i) * kStepNs, FeaturesAt(truth[i], i));
    row = result.motion ? row * result.motion->from_from_to : row;
    EXPECT_LT(row.Between(result.odom_from_base).Log().norm(), 1e-9) << i;
  }
}

TEST(PlanarOdometryTest, AnInitialGuessAllowsLargeSteps) {
  const std::vector<Pose2> truth = RoundTrip(12);
  PlanarOdometry odometry(Options());
  odometry.Track(0, FeaturesAt(truth[0], 0));
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const Pose2 step = truth[i - 1].Between(truth[i]);
    const Pose2 guess = step * Pose2(0.01, -0.005, 0.03);
    const PlanarOdometryResult result =
        odometry.Track(static_cast<std::int64_t>(i) * 4 * kStepNs, FeaturesAt(truth[i], i), guess);
    ASSERT_EQ(result.status, PlanarOdometryStatus::kTracked) << i << " " << ToString(result.loss);
    EXPECT_LT(step.Between(result.motion->from_from_to).translation().norm(), 2e-3) << i;
  }
}

// NEES of both covariances over several trips with independent noise: of each motion, and of the motion since the last
// keyframe, where the expectation of 3 is exact.
TEST(PlanarOdometryTest, CovariancesAreHonest) {
  const std::vector<Pose2> truth = RoundTrip(48);
  double alone = 0.0;
  double summed = 0.0;
  int count = 0;
  for (std::uint64_t trip = 0; trip < 3; ++trip) {
    PlanarOdometry odometry(WithoutSystematicErrors());
    AnchoredPose sum;
    std::size_t keyframe = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const PlanarOdometryResult result =
          odometry.Track(static_cast<std::int64_t>(i) * kStepNs, FeaturesAt(truth[i], 1000 * trip + i));
      if (result.motion) {
        const VisualMotion& motion = *result.motion;
        alone += Nees(truth[i - 1].Between(truth[i]), motion.from_from_to, motion.covariance_alone);
        sum.covariance = PropagatedCovariance(sum, motion.from_from_to, motion.covariance);
        sum.anchor_from_base = sum.anchor_from_base * motion.from_from_to;
        summed += Nees(truth[keyframe].Between(truth[i]), sum.anchor_from_base, sum.covariance);
        ++count;
      }
      if (result.new_keyframe) {
        sum = {};
        keyframe = i;
      }
    }
  }
  EXPECT_GT(alone / count, 1.2);
  EXPECT_LT(alone / count, 4.5);
  EXPECT_GT(summed / count, 1.2);
  EXPECT_LT(summed / count, 4.5);
}

TEST(PlanarOdometryTest, StandingStillDoesNotDrift) {
  const Pose2 pose = Floor().BaseForView(0.6, 0.45, 0.7);
  const cv::Mat clean = GrayView(Floor(), pose, 1);
  cv::RNG random(5);
  PlanarOdometry odometry(Options());
  double variance = 0.0;
  for (int i = 0; i < 200; ++i) {
    cv::Mat noise(clean.size(), CV_16SC1);
    random.fill(noise, cv::RNG::NORMAL, 5.0 * std::sin(0.05 * i), 3.0);
    cv::Mat gray;
    cv::add(clean, noise, gray, cv::noArray(), CV_8U);
    const PlanarOdometryResult result = odometry.Track(i * kStepNs, FeaturesOf(gray));
    ASSERT_EQ(result.status, i == 0 ? PlanarOdometryStatus::kFirstFrame : PlanarOdometryStatus::kTracked);
    EXPECT_EQ(result.new_keyframe, i == 0);
    EXPECT_LT(result.odom_from_base.translation().norm(), 3e-4) << i;
    EXPECT_LT(std::abs(result.odom_from_base.yaw()), 1e-3) << i;
    variance += result.motion ? result.motion->covariance(0, 0) + result.motion->covariance(1, 1) : 0.0;
  }
  EXPECT_GT(variance, 1e-10);
  EXPECT_LT(std::sqrt(variance), 6e-4) << "not much more than the systematic error of one registration";
}

TEST(PlanarOdometryTest, AnotherFloorIsALossAndTheOldOneIsFoundAgain) {
  const std::vector<Pose2> truth = RoundTrip(48);
  PlanarOdometry odometry(Options());
  odometry.Track(0, FeaturesAt(truth[0], 0));
  ASSERT_EQ(odometry.Track(kStepNs, FeaturesAt(truth[1], 1)).status, PlanarOdometryStatus::kTracked);
  const PlanarOdometryResult elsewhere = odometry.Track(2 * kStepNs, FeaturesOf(GrayView(OtherFloor(), truth[2], 2)));
  EXPECT_EQ(elsewhere.status, PlanarOdometryStatus::kLost);
  EXPECT_NE(elsewhere.loss, TrackingLoss::kNone);
  EXPECT_FALSE(elsewhere.motion);
  const PlanarOdometryResult back = odometry.Track(3 * kStepNs, FeaturesAt(truth[3], 3));
  ASSERT_EQ(back.status, PlanarOdometryStatus::kTracked);
  EXPECT_EQ(back.motion->from_ns, kStepNs) << "the motion spans the frame that was lost";
  EXPECT_EQ(back.chain, 0);
  EXPECT_LT(truth[0].Between(truth[3]).Between(back.odom_from_base).translation().norm(), 2e-3);
}

TEST(PlanarOdometryTest, GoesOnOnAnotherFloorInANewChain) {
  const std::vector<Pose2> truth = RoundTrip(48);
  PlanarOdometry odometry(Options());
  odometry.Track(0, FeaturesAt(truth[0], 0));
  const Pose2 before = odometry.Track(kStepNs, FeaturesAt(truth[1], 1)).odom_from_base;
  odometry.Track(2 * kStepNs, FeaturesOf(GrayView(OtherFloor(), truth[20], 2)));
  const PlanarOdometryResult after = odometry.Track(3 * kStepNs, FeaturesOf(GrayView(OtherFloor(), truth[21], 3)));
  ASSERT_EQ(after.status, PlanarOdometryStatus::kTracked) << ToString(after.loss);
  EXPECT_EQ(after.motion->from_ns, 2 * kStepNs);
  EXPECT_EQ(after.chain, 1);
  const Pose2 step = truth[20].Between(truth[21]);
  EXPECT_LT(step.Between(after.motion->from_from_to).translation().norm(), 1e-3);
  EXPECT_LT((before * step).Between(after.odom_from_base).translation().norm(), 1e-3);
}

TEST(PlanarOdometryTest, ABlackFrameIsBridgedByItsInitialGuess) {
  const std::vector<Pose2> truth = RoundTrip(48);
  PlanarOdometry odometry(Options());
  odometry.Track(0, FeaturesAt(truth[0], 0));
  odometry.Track(kStepNs, FeaturesAt(truth[1], 1));
  const Pose2 guess = truth[1].Between(truth[2]);
  const PlanarOdometryResult black = odometry.Track(2 * kStepNs, Features{}, guess);
  EXPECT_EQ(black.status, PlanarOdometryStatus::kLost);
  EXPECT_EQ(black.loss, TrackingLoss::kTooFewKeypoints);
  EXPECT_LT(truth[0].Between(truth[2]).Between(black.odom_from_base).translation().norm(), 2e-3);
  const PlanarOdometryResult next = odometry.Track(3 * kStepNs, FeaturesAt(truth[3], 3));
  ASSERT_EQ(next.status, PlanarOdometryStatus::kTracked);
  EXPECT_LT(truth[1].Between(truth[3]).Between(next.motion->from_from_to).translation().norm(), 1e-3);
}

TEST(PlanarOdometryTest, ImplausibleMotionIsRejected) {
  const std::vector<Pose2> truth = RoundTrip(12);
  PlanarOdometryOptions options = Options();
  options.max_speed_m_s = 0.2;  // the step is 0.1 m in 0.2 s
  PlanarOdometry slow(options);
  slow.Track(0, FeaturesAt(truth[0], 0));
  EXPECT_EQ(slow.Track(4 * kStepNs, FeaturesAt(truth[1], 1)).status, PlanarOdometryStatus::kLost);
  PlanarOdometry guessed(Options());
  guessed.Track(0, FeaturesAt(truth[0], 0));
  const PlanarOdometryResult result = guessed.Track(4 * kStepNs, FeaturesAt(truth[1], 1), Pose2(-0.2, 0.0, 0.0));
  EXPECT_EQ(result.status, PlanarOdometryStatus::kLost);
  EXPECT_EQ(result.loss, TrackingLoss::kContradictsGuess);
}

TEST(PlanarOdometryTest, RefusesStampsThatDoNotIncreaseAndStaysUsable) {
  const std::vector<Pose2> truth = RoundTrip(48);
  PlanarOdometry odometry(Options());
  const Features first = FeaturesAt(truth[0], 0);
  odometry.Track(kStepNs, first);
  EXPECT_THROW(odometry.Track(kStepNs, first), std::invalid_argument);
  EXPECT_THROW(odometry.Track(0, first), std::invalid_argument);
  EXPECT_THROW(odometry.Track(2 * kStepNs, first, Pose2(std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0)),
               std::invalid_argument);
  EXPECT_EQ(odometry.Track(2 * kStepNs, FeaturesAt(truth[1], 1)).status, PlanarOdometryStatus::kTracked);
  odometry.Reset();
  EXPECT_EQ(odometry.Track(0, first).status, PlanarOdometryStatus::kFirstFrame);
}

TEST(PlanarOdometryTest, RefusesBadOptions) {
  PlanarOdometryOptions options;
  options.min_overlap = 1.5;
  EXPECT_THROW(PlanarOdometry{options}, std::invalid_argument);
  options = {};
  options.max_speed_m_s = 0.0;
  EXPECT_THROW(PlanarOdometry{options}, std::invalid_argument);
}

// The part's keypoints stand still in all frames, and a search near the last pose finds them alone.
TEST(PlanarOdometry, APartOfTheRobotThatStandsStillIsNotTheVehicle) {
  for (const double share : {0.13, 0.3}) {
    OverlayOptions part;
    part.share = share;
    RenderConditions conditions;
    const CameraModel& camera = Floor().camera().camera;
    conditions.overlay = std::make_shared<const CameraOverlay>(part, cv::Size(camera.width_px, camera.height_px));
    PlanarOdometry odometry(Options());
    for (int i = 0; i < 6; ++i) {
      cv::Mat gray;
      cv::cvtColor(Floor().View(Floor().BaseForView(0.4 + 0.03 * i, 0.45, 0.0), conditions), gray, cv::COLOR_BGR2GRAY);
      const PlanarOdometryResult result = odometry.Track((i + 1) * kStepNs, FeaturesOf(gray));
      if (i == 0) {
        continue;
      }
      ASSERT_EQ(result.status, PlanarOdometryStatus::kTracked) << share << ", frame " << i;
      EXPECT_NEAR(result.odom_from_base.x(), 0.03 * i, 0.002) << share << ", frame " << i;
    }
  }
}

}  // namespace
}  // namespace floorloc
