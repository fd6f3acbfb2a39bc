// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/fleet/wheels_and_gyro.h"

#include <cmath>

#include "mapbuilder/simulation/simulated_noise.h"

namespace floorloc {

WheelsAndGyro::WheelsAndGyro(const OdometryErrors& wheels, const ImuErrors& imu, std::uint64_t seed)
    : wheels_(wheels, DeriveSeed(seed, 1)), imu_(imu), rng_(DeriveSeed(seed, 2)) {
  bias_rad_s_ = rng_.gaussian(imu.gyro_noise / std::sqrt(kGyroRateHz * kStandingS));
}

Eigen::Vector3d WheelsAndGyro::Measure(const Eigen::Vector3d& motion, double step_s) {
  Eigen::Vector3d measured = wheels_.Measure(motion);
  bias_rad_s_ += rng_.gaussian(imu_.gyro_walk * std::sqrt(step_s));
  const double samples = step_s * kGyroRateHz;
  measured.z() = motion.z() + step_s * (bias_rad_s_ + rng_.gaussian(imu_.gyro_noise / std::sqrt(samples)));
  return measured;
}

}  // namespace floorloc
