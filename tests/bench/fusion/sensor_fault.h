// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tests/bench/fusion/scenario.h"

namespace floorloc {

/// What is wrong with a vehicle's odometry or gyro from a time on. The fixes are right.
struct SensorFault {
  std::string name = {};
  double scale = 1.0;          ///< factor on distances
  double direction_rad = 0.0;  ///< turns the measured translation
  double yaw_factor = 1.0;     ///< factor on turns
  double late_s = 0.0;         ///< added to the stamps; all the time, not only after the onset
  double jump_m = 0.0;         ///< one step at the onset, to the left
  double lasts_s = 1e9;        ///< after the onset
  bool standing = false;       ///< wheels report no motion
  bool silent = false;         ///< there are no messages
  double gyro_factor = 1.0;
  double gyro_bias_rad_s = 0.0;
};

/// The faults of the table; the first one is none.
std::vector<SensorFault> AllSensorFaults();

/// Time after the start of a drive from which the odometry is faulty.
inline constexpr double kFaultOnsetS = 8.0;

/// The recording's wheels and IMU under a fault, and every `keep_every`th image, in the order of their true times.
std::vector<FusionMessage> MakeFaultyMessages(const FusionRecording& recording, const SensorFault& fault,
                                              int keep_every);

}  // namespace floorloc
