// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/gyro_monitor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "core/fusion/pose_filter.h"
#include "tests/core/fusion/drive_simulation.h"

namespace floorloc {
namespace {

using namespace fusion_test;  // NOLINT: names all of this file

constexpr std::int64_t kPerFixNs = 1'000'000'000;

using Change = std::function<double(double)>;  // of the yaw rate

double AsItIs(double yaw_rate) { return yaw_rate; }

// A drive with a fix per second, whose gyro is changed, judged by the monitor and by a filter with wheels.
class GyroMonitorTest : public testing::Test {
 protected:
  // spoil: changes fixes by their number.
  void DriveTo(double seconds, const Change& change, const std::function<void(int, PoseFix*)>& spoil = {}) {
    while (now_ns_ < kStartNs + ToNs(seconds)) {
      const std::int64_t next = now_ns_ + kImuNs;
      truth_ = truth_ * simulation_.Motion(DriveSimulation::Seconds(now_ns_), DriveSimulation::Seconds(next));
      now_ns_ = next;
      ImuReading reading = simulation_.Imu(now_ns_);
      reading.yaw_rate_rad_s = change(reading.yaw_rate_rad_s);
      imu_.Add(reading);
      filter_.AddImu(reading);
      if ((now_ns_ - kStartNs) % kWheelNs == 0) {
        filter_.AddIncrement(MotionSource::kWheels, simulation_.Wheels(now_ns_ - kWheelNs, now_ns_));
      }
      const std::optional<FusedPose> pose = filter_.Estimate();
      if (pose) {
        largest_error_m_ = std::max(largest_error_m_, truth_.Between(pose->map_from_base).translation().norm());
      }
      if ((now_ns_ - kStartNs) % kPerFixNs == 0) {
        PoseFix fix = simulation_.Fix(now_ns_, truth_);
        if (spoil) {
          spoil(++fixes_, &fix);
        }
        monitor_.AddFix(fix, imu_);
        filter_.AddFix(fix);
      }
    }
  }

  DriveSimulation simulation_{5};
  ImuTrack imu_;
  GyroMonitor monitor_{GyroMonitorOptions()};
  PoseFilter filter_;
  Pose2 truth_{1.0, 2.0, 0.7};
  std::int64_t now_ns_ = kStartNs;
  double largest_error_m_ = 0.0;
  int fixes_ = 0;
};

TEST_F(GyroMonitorTest, AGyroThatIsRightIsTrusted) {
  DriveTo(120.0, AsItIs);
  EXPECT_TRUE(monitor_.Trusted());
}

TEST_F(GyroMonitorTest, ABiasIsLeftToTheFilter) {
  DriveTo(120.0, [](double rate) { return rate + 0.05; });
  EXPECT_TRUE(monitor_.Trusted());
}

TEST_F(GyroMonitorTest, AWrongFixAccusesNoGyro) {
  DriveTo(120.0, AsItIs, [](int number, PoseFix* fix) {
    if (number % 4 == 0) {
      fix->map_from_base = fix->map_from_base * Pose2(3.0, 1.0, 2.0);
    }
  });
  EXPECT_TRUE(monitor_.Trusted());
}

TEST_F(GyroMonitorTest, IsTrustedAgainWhenItIsRight) {
  DriveTo(30.0, [](double rate) { return -rate; });
  EXPECT_FALSE(monitor_.Trusted());
  DriveTo(60.0, AsItIs);
  EXPECT_TRUE(monitor_.Trusted());
}

struct Fault {
  std::string name;
  Change change;
};
void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }

class WrongGyro : public GyroMonitorTest, public testing::WithParamInterface<Fault> {};

// Between the fixes of a second, with wheels.
TEST_P(WrongGyro, MovesNoPose) {
  DriveTo(20.0, AsItIs);
  DriveTo(35.0, GetParam().change);
  EXPECT_FALSE(monitor_.Trusted());
  largest_error_m_ = 0.0;
  DriveTo(90.0, GetParam().change);
  EXPECT_FALSE(monitor_.Trusted());
  EXPECT_LT(largest_error_m_, 0.03);
}

INSTANTIATE_TEST_SUITE_P(All, WrongGyro,
                         testing::Values(Fault{"reversed", [](double rate) { return -rate; }},
                                         Fault{"degrees", [](double rate) { return 57.29578 * rate; }},
                                         Fault{"stands", [](double) { return 0.0; }},
                                         Fault{"raw_counts", [](double rate) { return 7506.0 * rate; }}),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace floorloc
