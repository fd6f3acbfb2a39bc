// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/readout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/option_test_support.h"

namespace floorloc {
namespace {

using ::testing::HasSubstr;

const Eigen::Vector3d kTwist(1.0, -0.2, 0.5);

Readout Of(std::optional<double> seconds) {
  Readout readout;
  readout.seconds = seconds;
  return readout;
}

TEST(ReadoutTest, AKnownReadoutAndTwistAreCompensatedAlone) {
  const ReadoutMotion motion = MotionOfReadout(Of(0.02), kTwist);
  EXPECT_LT((motion.motion - 0.02 * kTwist).norm(), 1e-15);
  EXPECT_TRUE(motion.covariance.isZero());
}

TEST(ReadoutTest, AGlobalShutterNeedsNoTwist) {
  for (const auto& twist : {std::optional<Eigen::Vector3d>(kTwist), std::optional<Eigen::Vector3d>()}) {
    const ReadoutMotion motion = MotionOfReadout(Of(0.0), twist);
    EXPECT_TRUE(motion.motion.isZero());
    EXPECT_TRUE(motion.covariance.isZero());
  }
}

TEST(ReadoutTest, WithoutATwistALikelySpeedWidensTheCovariance) {
  const ReadoutOptions options;
  const ReadoutMotion motion = MotionOfReadout(Of(0.02), std::nullopt);
  EXPECT_TRUE(motion.motion.isZero());
  const double sigma_m = options.error_share * 0.02 * options.assumed_mps;
  EXPECT_NEAR(std::sqrt(motion.covariance(0, 0)), sigma_m, 1e-12);
  EXPECT_NEAR(std::sqrt(motion.covariance(1, 1)), sigma_m, 1e-12);
}

TEST(ReadoutTest, AnUnknownReadoutWidensTheCovarianceAlongTheMotion) {
  const Eigen::Matrix3d covariance = MotionOfReadout(Of(std::nullopt), Eigen::Vector3d(1.0, 0.0, 0.0)).covariance;
  EXPECT_NEAR(std::sqrt(covariance(0, 0)), 0.0165, 1e-6);
  EXPECT_EQ(covariance(1, 1), 0.0);
  const Eigen::Matrix3d slower = MotionOfReadout(Of(std::nullopt), Eigen::Vector3d(0.1, 0.0, 0.0)).covariance;
  EXPECT_NEAR(slower(0, 0), 0.01 * covariance(0, 0), 1e-12);
}

TEST(ReadoutTest, NothingIsAssumedOfARobotAndACameraThatTellNothing) {
  const ReadoutMotion motion = MotionOfReadout({}, std::nullopt);
  EXPECT_TRUE(motion.motion.isZero());
  EXPECT_TRUE(motion.covariance.isZero());
}

TEST(ReadoutTest, StampsOfFirstAndLastRowsAreMovedByHalfTheReadout) {
  Readout readout = Of(0.03);
  EXPECT_EQ(readout.StampShiftNs(), 0);
  readout.stamp_at = StampAt::kStart;
  EXPECT_EQ(readout.StampShiftNs(), 15'000'000);
  readout.stamp_at = StampAt::kEnd;
  EXPECT_EQ(readout.StampShiftNs(), -15'000'000);
}

TEST(ReadoutTest, NamesAreReadAsTheyAreWritten) {
  for (const auto direction :
       {ReadoutDirection::kDown, ReadoutDirection::kUp, ReadoutDirection::kRight, ReadoutDirection::kLeft}) {
    EXPECT_EQ(ParseReadoutDirection(ToString(direction)), direction);
  }
  for (const auto at : {StampAt::kStart, StampAt::kMiddle, StampAt::kEnd}) {
    EXPECT_EQ(ParseStampAt(ToString(at)), at);
  }
  EXPECT_THROW(ParseReadoutDirection("Down"), std::invalid_argument);
  EXPECT_THROW(ParseStampAt(""), std::invalid_argument);
}

TEST(ReadoutTest, RefusesReadoutsThatNoCameraHas) {
  for (const double seconds : {-0.001, 0.21, std::nan("")}) {
    EXPECT_THAT(Diagnostic(Of(seconds)), HasSubstr("readout_s must be the seconds")) << seconds;
  }
  EXPECT_EQ(Diagnostic(Of(0.2)), "");
  Readout readout;
  readout.stamp_at = StampAt::kEnd;
  EXPECT_THAT(Diagnostic(readout), HasSubstr("stamp_at start or end needs readout_s"));
}

TEST(ReadoutTest, EachBadOptionIsRefusedByName) {
  OptionTable<ReadoutOptions>()
      .Refuses("assumed_s", &ReadoutOptions::assumed_s, {-0.1, 0.3})
      .Refuses("assumed_mps", &ReadoutOptions::assumed_mps, {-1.0})
      .Refuses("assumed_radps", &ReadoutOptions::assumed_radps, {-1.0})
      .Refuses("error_share", &ReadoutOptions::error_share, {-0.1, 1.1})
      .Refuses("residual_share", &ReadoutOptions::residual_share, {-0.1, 1.1});
}

}  // namespace
}  // namespace floorloc
