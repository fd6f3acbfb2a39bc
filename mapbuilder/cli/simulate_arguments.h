// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "mapbuilder/fleet/fleet_options.h"
#include "mapbuilder/simulation/simulate.h"

namespace floorloc {

/// Raw command line arguments, to be converted to SimulateOptions or FleetOptions.
struct SimulateArguments {
  SimulateOptions options;
  std::string size = "2.6x1.8";
  std::string trajectory = "survey";
  std::string camera = "down";
  std::string condition = "mild";
  double camera_height_m = 0.0;  ///< 0: the built-in camera's
  std::string camera_yaml;
  std::string floor_yaml;
  bool keep_direction = false;
  bool no_odometry = false;
  bool exact_calibration = false;
  std::optional<double> radial_error, tangential_error, principal_point_error, focal_error;
  std::optional<double> roll_error_deg, pitch_error_deg, height_error;
  double odometry_drift = 1.0;
  double imu_errors = 1.0;
  std::optional<double> odometry_rate, imu_rate, speed_variation;
  std::optional<double> height_variation;
  std::optional<double> blur_px, shadow, lamps, noise, rolling_shutter_s;
  std::optional<int> jpeg_quality;
  std::string overlay;
  double overlay_share = 0.05;
  FleetOptions fleet;
  bool json = false;
};

// All throw InputError or std::invalid_argument.
FloorCamera ChooseCamera(const SimulateArguments& arguments);
ConditionLevels ChooseConditions(const SimulateArguments& arguments);
CalibrationError ChooseCalibrationError(const SimulateArguments& arguments);

}  // namespace floorloc
