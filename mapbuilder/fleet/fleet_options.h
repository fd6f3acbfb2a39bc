// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "core/geometry/floor_plane.h"
#include "mapbuilder/fleet/fleet_schedule.h"
#include "mapbuilder/fleet/roaming_drive.h"
#include "mapbuilder/simulation/calibration_error.h"
#include "mapbuilder/simulation/render_conditions.h"
#include "mapbuilder/simulation/simulated_sensors.h"

namespace floorloc {

struct FleetOptions {
  std::string server;
  std::string token;
  std::string map;                ///< empty: the only one that is served
  std::string prefix = "fleet-";  ///< of the vehicles' names
  bool keep_vehicles = false;     ///< leaves them registered at the end
  double seconds = 0.0;           ///< 0: until it is stopped
  double rate_hz = 1.0;           ///< images per second and vehicle at most; less when the server wants less
  double max_area_m2 = 50.0;      ///< of the floor that is driven on: 6 MB per square metre at 0.7 mm per pixel
  int threads = 0;                ///< that render; 0: one per core

  FloorCamera camera;  ///< takes the images
  /// Each vehicle's calibration is off by -1 to 1 times this.
  CalibrationError calibration_error;
  ConditionLevels conditions;
  OdometryErrors odometry;
  ImuErrors imu;
  double clock_jitter_s = 0.001;  ///< standard deviation of an image's stamp
  DriveLimits drive;
  ScheduleOptions schedule;

  double odometry_batch_s = 0.2;  ///< of wheel steps that are sent together
  double call_deadline_s = 2.0;   ///< of one call
  double give_up_s = 15.0;        ///< without any answer of the server
  /// A pose is right, and a carried vehicle found again, within these.
  double right_m = 0.05;
  double right_rad = 0.05;
  std::uint64_t seed = 1;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

}  // namespace floorloc
