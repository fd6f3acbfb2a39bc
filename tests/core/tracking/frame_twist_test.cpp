// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/frame_twist.h"

#include <gtest/gtest.h>

#include <memory>

namespace floorloc {
namespace {

constexpr std::int64_t kStartNs = 1'000'000'000'000;

// Wheels whose twist is `at_start` plus time times `change`, reported at a rate until `seconds`.
class WheelDrive {
 public:
  WheelDrive(double rate_hz, const Eigen::Vector3d& at_start, const Eigen::Vector3d& change)
      : step_ns_(static_cast<std::int64_t>(1e9 / rate_hz)), at_start_(at_start), change_(change) {}

  Eigen::Vector3d TwistAfter(double seconds) const { return at_start_ + seconds * change_; }

  // The estimate at an image that is `late_s` later than the last message.
  std::optional<Eigen::Vector3d> Estimate(double seconds, double late_s, const FrameTwistOptions& options = {}) {
    while (1e-9 * static_cast<double>(now_ns_) < seconds - 1e-6) {
      const double middle_s = 1e-9 * (static_cast<double>(now_ns_) + 0.5 * static_cast<double>(step_ns_));
      const MotionIncrement increment{kStartNs + now_ns_, kStartNs + now_ns_ + step_ns_,
                                      Pose2::Exp(1e-9 * static_cast<double>(step_ns_) * TwistAfter(middle_s)),
                                      std::nullopt};
      fuser_->AddIncrement(MotionSource::kWheels, increment);
      now_ns_ += step_ns_;
      last_ = {increment.to_ns, increment};
    }
    return TwistAtFrame(*fuser_, last_, kStartNs + now_ns_ + static_cast<std::int64_t>(1e9 * late_s), options);
  }

 private:
  std::int64_t step_ns_;
  Eigen::Vector3d at_start_, change_;
  std::int64_t now_ns_ = 0;
  LastMotion last_;
  std::unique_ptr<PoseFuser> fuser_ = MakePoseFuser(FusionMethod::kEkf, {});
};

TEST(FrameTwistTest, IsThatAtTheImageAndNotTheMeanBeforeIt) {
  for (const double rate_hz : {10.0, 50.0, 100.0}) {
    for (const double late_s : {0.0, 0.01}) {
      WheelDrive drive(rate_hz, {0.2, 0.0, -0.5}, {0.8, 0.0, 2.0});
      const std::optional<Eigen::Vector3d> twist = drive.Estimate(1.0, late_s);
      ASSERT_TRUE(twist.has_value());
      const double extrapolated_s = std::min(late_s + std::max(0.02, 0.5 / rate_hz), 0.05);
      const double missing_s = late_s + std::max(0.02, 0.5 / rate_hz) - extrapolated_s;
      EXPECT_LT((*twist - drive.TwistAfter(1.0 + late_s)).norm(), 2.2 * missing_s + 0.01) << rate_hz << ' ' << late_s;
    }
  }
}

TEST(FrameTwistTest, ChangesNoFasterThanAVehicleCan) {
  FrameTwistOptions options;
  options.max_acceleration_mps2 = 1.0;
  options.max_turn_acceleration_radps2 = 2.0;
  WheelDrive drive(50.0, {0.0, 0.0, 0.0}, {4.0, 0.0, 10.0});
  const std::optional<Eigen::Vector3d> twist = drive.Estimate(1.0, 0.0, options);
  ASSERT_TRUE(twist.has_value());
  const Eigen::Vector3d mean = drive.TwistAfter(0.98);
  EXPECT_NEAR(twist->x(), mean.x() + 0.02 * 1.0, 0.01);
  EXPECT_NEAR(twist->z(), mean.z() + 0.02 * 2.0, 0.01);
}

TEST(FrameTwistTest, IsUnknownWhereTheLastMotionIsOld) {
  WheelDrive drive(50.0, {0.5, 0.0, 0.0}, Eigen::Vector3d::Zero());
  EXPECT_TRUE(drive.Estimate(1.0, 0.4).has_value());
  EXPECT_FALSE(drive.Estimate(1.0, 0.6).has_value());
}

}  // namespace
}  // namespace floorloc
