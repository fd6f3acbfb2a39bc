// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/replay/drive_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/io/input_error.h"

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
  Finding About(const std::string& about) const {
    Finding worst{"", FindingStatus::kOk, "nothing", ""};
    for (const Finding& finding : CheckDrive(drive_, fused_)) {
      if (finding.about == about && (worst.about.empty() || finding.status > worst.status)) {
        worst = finding;
      }
    }
    return worst;
  }
  void Expect(const std::string& about, FindingStatus status, const std::string& text) const {
    const Finding finding = About(about);
    EXPECT_EQ(finding.status, status) << finding.sentence;
    EXPECT_THAT(finding.sentence + " -> " + finding.cure, HasSubstr(text));
  }

  Survey drive_;
  FusedDrive fused_;
};

TEST_F(DriveCheckTest, ImagesThatAreCompressedTooMuchAreSaidSo) {
  ForFrames(0, kFrames, [](FusedFrame& frame) { frame.localized.result.poor_jpeg_quality = 20; });
  Expect("images", FindingStatus::kNote, "JPEG quality 20");
  ForFrames(0, kFrames / 2, [](FusedFrame& frame) {
    frame.localized.result.status = LocalizationStatus::kNotLocalized;
    frame.localized.result.reason = NotLocalizedReason::kTooFewInliers;
  });
  Expect("images", FindingStatus::kWrong, "JPEG quality 20");
  ForFrames(0, kFrames / 2 + 1, [](FusedFrame& frame) { frame.localized.result.poor_jpeg_quality.reset(); });
  EXPECT_EQ(About("images").sentence.find("JPEG"), std::string::npos) << "less than half of the images";
}

TEST_F(DriveCheckTest, ARobotThatIsWiredRightPasses) {
  for (const Finding& finding : CheckDrive(drive_, fused_)) {
    EXPECT_EQ(finding.status, FindingStatus::kOk) << finding.sentence;
  }
  EXPECT_EQ(CheckDrive(drive_, fused_).size(), 6U);
}

// All images of a recording count, not only the last ones as on a server.
TEST_F(DriveCheckTest, TheWholeDriveIsJudged) {
  for (int i = 0; i < 4; ++i) {
    fused_.frames.insert(fused_.frames.end(), fused_.frames.begin(), fused_.frames.begin() + kFrames);
  }
  ForFrames(0, 20, [](FusedFrame& frame) { frame.localized.result.status = LocalizationStatus::kNotLocalized; });
  Expect("floor", FindingStatus::kOk, "280 of 300 images");
}

TEST_F(DriveCheckTest, CameraAndOdometryAreThoseOfTheReplay) {
  fused_.camera.status = CameraStatus::kCorrected;
  fused_.camera_off_px = 7.5;
  Expect("camera", FindingStatus::kNote, "off by up to 7.5 px");
  ForFrames(20, 60, [](FusedFrame& frame) {
    frame.pose->odometry = OdometryTrust{OdometryHealth::kRejected, OdometryFault::kReversed, -1.0, 1.0, 0.0};
  });
  Expect("odometry", FindingStatus::kWrong, "change the sign of dx and dy");
}

// Such a drive is replayed without its odometry, and judged with it.
TEST_F(DriveCheckTest, AnotherEpochIsNamedWithBothRanges) {
  for (StampedPose3& pose : drive_.odometry) {
    pose.stamp_ns -= kStart;
  }
  const Finding clock = About("clock");
  EXPECT_EQ(clock.status, FindingStatus::kWrong);
  EXPECT_THAT(clock.sentence, AllOf(HasSubstr("1700000000.0"), HasSubstr("odometry from 0.0 to 12.0 s")));
  EXPECT_TRUE(WithoutForeignClocks(drive_).odometry.empty());
  EXPECT_FALSE(WithoutForeignClocks(drive_).imu.empty());
}

TEST_F(DriveCheckTest, AGyroOfAnotherEpochIsNamedWithBothRanges) {
  for (ImuSample& sample : drive_.imu) {
    sample.stamp_ns -= kStart;
  }
  Expect("gyro", FindingStatus::kWrong, "the IMU from 0.0 to 12.0 s");
  EXPECT_FALSE(WithoutForeignClocks(drive_).odometry.empty());
  EXPECT_TRUE(WithoutForeignClocks(drive_).imu.empty());
}

TEST_F(DriveCheckTest, AReplayRefusesForeignClocks) {
  EXPECT_NO_THROW(CheckClocks(drive_, true));
  for (ImuSample& sample : drive_.imu) {
    sample.stamp_ns -= kStart;
  }
  EXPECT_NO_THROW(CheckClocks(drive_, false));
  try {
    CheckClocks(drive_, true);
    FAIL() << "foreign clocks were accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("imu.csv"), HasSubstr("from 0.0 to 12.0 s"), HasSubstr("Unix time")));
  }
}

TEST_F(DriveCheckTest, AGyroThatIsWiredWronglyIsNamed) {
  Gyro(-1.0, 0.0);
  Expect("gyro", FindingStatus::kWrong, "z up");
  Gyro(57.29578, 0.0);
  Expect("gyro", FindingStatus::kWrong, "degrees per second");
  Gyro(1.2, 0.0);
  Expect("gyro", FindingStatus::kWrong, "scale 0.833");
  Gyro(1.0, 0.05);
  Expect("gyro", FindingStatus::kNote, "bias +0.0500 rad/s");
}

// Lifted, turned and put down: the gyro measures another turn than the fixes show.
TEST_F(DriveCheckTest, AVehicleThatIsCarriedDoesNotBlameTheGyro) {
  ForFrames(30, 60, [](FusedFrame& frame) {
    frame.localized.result.map_from_base = Pose2(3.0, 1.0, 2.0) * frame.localized.result.map_from_base;
  });
  Expect("gyro", FindingStatus::kOk, "scale 1.000");
}

TEST_F(DriveCheckTest, RefusesBadOptions) {
  EXPECT_THROW(CheckDrive(drive_, fused_, {.max_gap_s = 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
