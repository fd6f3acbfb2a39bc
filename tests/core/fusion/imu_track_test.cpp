// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/imu_track.h"

#include <gtest/gtest.h>

namespace floorloc {
namespace {

constexpr std::int64_t kStepNs = 10'000'000;

// Mean rates since the reading before, of a vehicle whose yaw rate and forward acceleration grow from zero on, by 2
// rad/s and 1 m/s^2 in a second.
ImuTrack Growing(int steps) {
  ImuTrack track;
  for (int i = 0; i <= steps; ++i) {
    const double mean = 0.01 * (i - 0.5);
    track.Add({i * kStepNs, 2.0 * mean, {mean, 0.0}});
  }
  return track;
}

TEST(ImuTrack, AReadingIsTheMeanSinceTheOneBefore) {
  const ImuMotion motion = Growing(100).Between(0, 100 * kStepNs, {});
  EXPECT_NEAR(motion.yaw_rad, 1.0, 1e-9) << "taken for the rate at its stamp, each would be half an interval late";
  EXPECT_NEAR(Growing(50).Between(0, 50 * kStepNs, {}).velocity_m_s.norm(), 0.125, 0.001);
}

TEST(ImuTrack, IntegratesPartsOfIntervals) {
  const ImuTrack track = Growing(100);
  const double whole = track.Between(0, 100 * kStepNs, {}).yaw_rad;
  const std::int64_t middle_ns = 33 * kStepNs + kStepNs / 4;
  const double parts = track.Between(0, middle_ns, {}).yaw_rad + track.Between(middle_ns, 100 * kStepNs, {}).yaw_rad;
  EXPECT_NEAR(parts, whole, 1e-12);
}

TEST(ImuTrack, LeavesTheBiasOut) {
  const ImuMotion motion = Growing(100).Between(0, 100 * kStepNs, {0.5, {0.0, 0.0}});
  EXPECT_NEAR(motion.yaw_rad, 0.5, 1e-9);
}

}  // namespace
}  // namespace floorloc
