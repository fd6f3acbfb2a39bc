// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/odometry_clock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

namespace floorloc {
namespace {

constexpr std::int64_t kStartNs = 1'700'000'000'000'000'000;

std::int64_t ToNs(double seconds) { return kStartNs + std::llround(1e9 * seconds); }

// A curved drive with changing speed.
Pose2 Winding(double s) {
  return {0.3 * s + 0.1 * std::sin(0.7 * s), 0.4 * std::sin(0.5 * s), 0.9 * std::sin(0.4 * s)};
}
// Nothing in it tells a time.
Pose2 Straight(double s) { return {0.3 * s, 0.0, 0.0}; }

using Path = Pose2 (*)(double);

struct Noise {
  double m = 0.0;  // of a step of the odometry
  double rad = 0.0;
};

// Odometry over 60 s; increments by `change`.
Trajectory Odometry(Path path, double rate_hz, const Noise& noise, Pose2 (*change)(const Pose2&)) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  Trajectory odometry;
  Pose2 pose;
  for (double s = 0.0; s < 60.0; s += 1.0 / rate_hz) {
    odometry.push_back(StampedPose3::FromPose2(ToNs(s), pose));
    const Pose2 step = path(s).Between(path(s + 1.0 / rate_hz));
    pose = pose * change(step) * Pose2(noise.m * normal(random), noise.m * normal(random), noise.rad * normal(random));
  }
  return odometry;
}

Pose2 AsItIs(const Pose2& step) { return step; }

// Images at 2 per second, stamped `late_s` after they were taken.
std::vector<TimedMotion> Motions(Path path, double late_s) {
  std::vector<TimedMotion> motions;
  for (double s = 2.0; s < 57.0; s += 0.5) {
    motions.push_back({ToNs(s + late_s), ToNs(s + 0.5 + late_s), path(s).Between(path(s + 0.5))});
  }
  return motions;
}

std::optional<std::int64_t> Find(const std::vector<TimedMotion>& motions, const Trajectory& odometry) {
  return FindImageDelayNs(motions, odometry, {});
}

TEST(OdometryClockTest, FindsHowLateImagesAreStamped) {
  const Trajectory odometry = Odometry(Winding, 50.0, {0.0005, 0.001}, AsItIs);
  for (const double late_s : {0.3, 0.096, -0.3, 0.7}) {
    const auto found_ns = Find(Motions(Winding, late_s), odometry);
    ASSERT_TRUE(found_ns) << late_s;
    EXPECT_NEAR(1e-9 * static_cast<double>(*found_ns), late_s, 0.015);
  }
}

TEST(OdometryClockTest, FindsItBesideAScaleAndAStandingEncoder) {
  Trajectory odometry = Odometry(Winding, 50.0, {0.0005, 0.001},
                                 [](const Pose2& step) { return Pose2(1.05 * step.x(), step.y(), step.yaw()); });
  for (std::size_t i = 1000; i < 1500; ++i) {
    odometry[i] = StampedPose3::FromPose2(odometry[i].stamp_ns, odometry[1000].ToPose2());
  }
  const auto found_ns = Find(Motions(Winding, 0.3), odometry);
  ASSERT_TRUE(found_ns);
  EXPECT_NEAR(1e-9 * static_cast<double>(*found_ns), 0.3, 0.02);
}

TEST(OdometryClockTest, ClocksThatAgreeStayAsTheyAre) {
  EXPECT_FALSE(Find(Motions(Winding, 0.0), Odometry(Winding, 50.0, {0.0005, 0.001}, AsItIs)));
  EXPECT_FALSE(Find(Motions(Winding, 0.01), Odometry(Winding, 50.0, {0.0005, 0.001}, AsItIs)));
}

// Interpolated between rows, noise is less: that is no evidence.
TEST(OdometryClockTest, CoarseNoisyOdometryIsNotMoved) {
  EXPECT_FALSE(Find(Motions(Winding, 0.0), Odometry(Winding, 2.0, {0.01, 0.02}, AsItIs)));
  EXPECT_FALSE(Find(Motions(Straight, 0.0), Odometry(Straight, 2.0, {0.01, 0.02}, AsItIs)));
}

TEST(OdometryClockTest, MotionsThatDoNotTellAnOffsetFindNone) {
  EXPECT_FALSE(Find(Motions(Straight, 0.3), Odometry(Straight, 50.0, {0.0005, 0.001}, AsItIs)));
  EXPECT_FALSE(Find({}, Odometry(Winding, 50.0, {}, AsItIs)));
}

TEST(OdometryClockTest, OdometryThatIsWrongOtherwiseIsNotTheClocks) {
  const auto reversed = [](const Pose2& step) { return Pose2(-step.x(), -step.y(), step.yaw()); };
  const auto mirrored = [](const Pose2& step) { return Pose2(step.x(), -step.y(), -step.yaw()); };
  const auto half = [](const Pose2& step) { return Pose2(0.5 * step.x(), 0.5 * step.y(), step.yaw()); };
  EXPECT_FALSE(Find(Motions(Winding, 0.0), Odometry(Winding, 50.0, {}, reversed)));
  EXPECT_FALSE(Find(Motions(Winding, 0.0), Odometry(Winding, 50.0, {}, mirrored)));
  EXPECT_FALSE(Find(Motions(Winding, 0.0), Odometry(Winding, 50.0, {}, half)));
}

TEST(OdometryClockOptionsTest, RefusesNonsense) {
  EXPECT_NO_THROW(OdometryClockOptions().Check());
  OdometryClockOptions options;
  options.max_offset_s = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(options.Check(), std::invalid_argument);
  options = {};
  options.max_left = 1.0;
  EXPECT_THROW(options.Check(), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
