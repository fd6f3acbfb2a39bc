// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/replay/drive_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace floorloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::int64_t kStart = 1'700'000'000'000'000'000;
constexpr int kFrames = 60;

std::int64_t At(double seconds) { return kStart + static_cast<std::int64_t>(std::llround(1e9 * seconds)); }

// Turns right and left: 0.8 m/s and up to 0.9 rad/s.
Pose2 TruthAt(double seconds) { return {0.8 * seconds, 0.1 * std::sin(seconds), 0.9 * std::sin(seconds)}; }

// A drive of 12 s with 5 images, 20 odometry poses and 100 IMU readings per second, and what a tracker that finds
// nothing wrong makes of it.
class DriveCheckTest : public ::testing::Test {
 protected:
  DriveCheckTest() {
    drive_.camera.floor.roi = {0.0, 0.5, -0.4, 0.4};
    fused_.camera.status = CameraStatus::kAsCalibrated;
    for (int i = 0; i < kFrames; ++i) {
      FusedFrame frame;
      frame.localized.frame = {At(0.2 * i), "images/0.jpg"};
      frame.localized.result.status = LocalizationStatus::kLocalized;
      frame.localized.result.map_from_base = TruthAt(0.2 * i);
      frame.pose = FusedPose();
      frame.pose->odometry = OdometryTrust{OdometryHealth::kOk, OdometryFault::kNone, 1.01, 0.99, 0.0};
      drive_.frames.push_back(frame.localized.frame);
      fused_.frames.push_back(frame);
    }
    for (int i = 0; i <= 240; ++i) {
      drive_.odometry.push_back(StampedPose3::FromPose2(At(0.05 * i), TruthAt(0.05 * i)));
    }
    Gyro(1.0, 0.005);
  }

  void Gyro(double factor, double bias) {
    drive_.imu.clear();
    for (int i = 1; i <= 1200; ++i) {
      const double rate = (TruthAt(0.01 * i).yaw() - TruthAt(0.01 * (i - 1)).yaw()) / 0.01;
      drive_.imu.push_back({At(0.01 * i), {0.0, 0.0, factor * rate + bias}, {0.0, 0.0, 9.81}});
    }
  }

  template <typename Change>
  void ForFrames(int first, int last, const Change& change) {
    std::for_each(fused_.frames.begin() + first, fused_.frames.begin() + last, change);
  }

  // The worst finding about a part.
  CheckFinding About(const std::string& about) const {
    CheckFinding worst{"", CheckStatus::kOk, "nothing"};
    for (const CheckFinding& finding : CheckDrive(drive_, fused_)) {
      if (finding.about == about && (worst.about.empty() || finding.status > worst.status)) {
        worst = finding;
      }
    }
    return worst;
  }
  void Expect(const std::string& about, CheckStatus status, const std::string& text) const {
    const CheckFinding finding = About(about);
    EXPECT_EQ(finding.status, status) << finding.sentence;
    EXPECT_THAT(finding.sentence, HasSubstr(text));
  }

  Survey drive_;
  FusedDrive fused_;
};

TEST_F(DriveCheckTest, ARobotThatIsWiredRightPasses) {
  for (const CheckFinding& finding : CheckDrive(drive_, fused_)) {
    EXPECT_EQ(finding.status, CheckStatus::kOk) << finding.sentence;
  }
  EXPECT_EQ(CheckDrive(drive_, fused_).size(), 6U);
}

TEST_F(DriveCheckTest, ImagesOfAnotherFloorAreNamed) {
  ForFrames(0, 55, [](FusedFrame& frame) {
    frame.localized.result.status = LocalizationStatus::kNotLocalized;
    frame.localized.result.reason = NotLocalizedReason::kTooFewInliers;
  });
  Expect("floor", CheckStatus::kWrong, "5 of 60 images were found in the map; they do not match the map");
}

TEST_F(DriveCheckTest, DarkImagesAreNamed) {
  ForFrames(0, 20, [](FusedFrame& frame) {
    frame.localized.result.status = LocalizationStatus::kNotLocalized;
    frame.localized.result.reason = NotLocalizedReason::kTooFewKeypoints;
  });
  Expect("floor", CheckStatus::kNote, "too little structure");
}

TEST_F(DriveCheckTest, ImagesFarApartAreNamed) {
  drive_.camera.floor.roi = {0.0, 0.2, -0.1, 0.1};
  Expect("images", CheckStatus::kNote, "images are up to 0.1");
}

TEST_F(DriveCheckTest, ABumpedCameraIsNamed) {
  fused_.camera.errors.mean(0) = 0.0175;
  fused_.camera.status = CameraStatus::kCorrected;
  Expect("camera", CheckStatus::kNote, "roll +1.00");
  fused_.camera.status = CameraStatus::kImplausible;
  Expect("camera", CheckStatus::kWrong, "calibrate it anew");
}

TEST_F(DriveCheckTest, AFaultOfTheWheelsIsNamedWithItsCure) {
  ForFrames(20, 60, [](FusedFrame& frame) {
    frame.pose->odometry = OdometryTrust{OdometryHealth::kRejected, OdometryFault::kReversed, -1.0, 1.0, 0.0};
  });
  Expect("odometry", CheckStatus::kWrong, "change the sign of dx and dy");
}

TEST_F(DriveCheckTest, ASlipIsANote) {
  ForFrames(20, 26, [](FusedFrame& frame) { frame.pose->odometry->fault = OdometryFault::kInconsistent; });
  Expect("odometry", CheckStatus::kNote, "contradicted 6 of 60 images");
}

TEST_F(DriveCheckTest, OtherClocksAreNamed) {
  ForFrames(0, 60, [](FusedFrame& frame) { frame.pose->odometry->time_offset_s = 0.096; });
  Expect("clock", CheckStatus::kNote, "odometry is stamped 96 ms later than the images");
}

TEST_F(DriveCheckTest, AnotherEpochIsNamedWithBothRanges) {
  for (StampedPose3& pose : drive_.odometry) {
    pose.stamp_ns -= kStart;
  }
  EXPECT_THAT(About("odometry").sentence, AllOf(HasSubstr("1700000000.0"), HasSubstr("from 0.0 to 12.0 s")));
  EXPECT_EQ(About("odometry").status, CheckStatus::kWrong);
}

TEST_F(DriveCheckTest, GapsAreNamed) {
  drive_.odometry.erase(drive_.odometry.begin() + 100, drive_.odometry.begin() + 130);
  Expect("odometry", CheckStatus::kNote, "a gap of 1.6 s");
}

TEST_F(DriveCheckTest, AGyroThatIsWiredWronglyIsNamed) {
  Gyro(-1.0, 0.0);
  Expect("gyro", CheckStatus::kWrong, "z axis points down");
  Gyro(57.29578, 0.0);
  Expect("gyro", CheckStatus::kWrong, "degrees per second");
  Gyro(1.2, 0.0);
  Expect("gyro", CheckStatus::kWrong, "scale 0.833");
  Gyro(1.0, 0.05);
  Expect("gyro", CheckStatus::kNote, "bias +0.0500 rad/s");
}

// Lifted, turned and put down: the gyro measures another turn than the fixes show.
TEST_F(DriveCheckTest, AVehicleThatIsCarriedDoesNotBlameTheGyro) {
  ForFrames(30, 60, [](FusedFrame& frame) {
    frame.localized.result.map_from_base = Pose2(3.0, 1.0, 2.0) * frame.localized.result.map_from_base;
  });
  Expect("gyro", CheckStatus::kOk, "scale 1.000");
}

TEST_F(DriveCheckTest, ADriveStraightOnDoesNotJudgeTheGyro) {
  ForFrames(0, 60, [](FusedFrame& frame) {
    frame.localized.result.map_from_base = Pose2(frame.localized.result.map_from_base.x(), 0.0, 0.0);
  });
  Expect("gyro", CheckStatus::kNote, "too few turns");
}

TEST_F(DriveCheckTest, RefusesBadOptions) {
  EXPECT_THROW(CheckDrive(drive_, fused_, {.max_gap_s = 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
