// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/simulation/calibration_error.h"
#include "mapbuilder/simulation/floor_texture.h"
#include "mapbuilder/simulation/render_conditions.h"
#include "mapbuilder/simulation/simulated_camera.h"
#include "mapbuilder/simulation/simulated_path.h"

namespace floorloc {

struct SimulateOptions {
  std::filesystem::path out;  ///< must not exist or be empty
  FloorTextureOptions floor;
  FloorCamera camera = MakeDownwardCamera();  ///< takes the images
  /// Of the calibration that is written beside the images; if there is one, the true calibration is written as
  /// camera_truth.yaml and floor_truth.yaml.
  CalibrationError calibration_error;
  PathOptions path;  ///< Simulate() fills in floor size, view and seed
  ConditionLevels conditions;
  double wear = 0.0;  ///< share of the floor to change by wear
  bool write_odometry = true;
  std::uint64_t seed = 1;  ///< for everything but the floor itself
  RunOptions run;          ///< does not change the files

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

struct SimulationResult {
  int frames = 0;
  double path_length_m = 0.0;     ///< 0 for random poses
  double odometry_drift_m = 0.0;  ///< odometry minus truth at the last frame
  double odometry_drift_rad = 0.0;
  double wear_share = 0.0;  ///< share of the floor actually changed
  double floor_s = 0.0;     ///< duration of making the floor
  double render_s = 0.0;    ///< duration of rendering and writing the frames
};

/// Writes a recording in the survey format with exact ground truth (groundtruth.tum, map frame: x right, y up, origin
/// at the floor's lower left corner; groundtruth_dense.tum at the odometry's stamps if it has a rate of its own) and
/// the events of a drive (events.csv: timestamp,duration,event; seconds; kidnap, stop or slip). The folder appears only
/// when complete; equal options give equal bytes. Throws InputError (image unreadable, folder not empty, disk full) or
/// std::invalid_argument (options).
SimulationResult Simulate(const SimulateOptions& options);

}  // namespace floorloc
