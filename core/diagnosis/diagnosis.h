// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/diagnosis/drive_record.h"
#include "core/diagnosis/finding.h"
#include "core/diagnosis/gyro_fit.h"
#include "core/geometry/floor_plane.h"
#include "core/tracking/camera_estimator.h"

namespace floorloc {

/// Limits between ok, note and wrong. A robot that is wired right passes them (tests/core/diagnosis, maps/sample).
struct DiagnosisOptions {
  int min_images = 10;                ///< before, nothing is said of the floor
  double min_localized_share = 0.9;   ///< of the images: fewer are a note,
  double lost_localized_share = 0.2;  ///< and fewer than this say that floor and map do not belong together
  /// Images that are not found at so many times the speed of those that are found are blurred; an exposure that blurs
  /// by two pixels at one speed blurs by three at the other (tests/core/diagnosis).
  double blur_speed_ratio = 1.5;
  double max_step_share = 0.5;    ///< of a view between images, which else do not show the same floor
  double max_gap_s = 0.5;         ///< in odometry: a controller drives blind for so long (MotionPrior::coast_s)
  double max_offset_s = 0.02;     ///< between clocks: at 1 m/s an image is 2 cm from where it seems to be
  double max_faulty_share = 0.2;  ///< of the images that odometry may contradict, as it does after a slip
  double max_scale_error = 0.03;  ///< of odometry: wheels that nobody calibrated err by 2 % (Borenstein & Feng 1996)
  double max_stamp_lag_s = 5.0;  ///< of messages of one clock: what is later is not used (PoseFilterOptions::history_s)
  double max_interval_s = 5.0;   ///< between odometry messages: more are stamps in another unit
  double max_backward_share = 0.1;    ///< of odometry's stamps: networks swap some messages
  std::size_t max_silent_images = 5;  ///< that come without odometry in between, before it counts as silent
  double max_gyro_scale_error = 0.05;
  double max_gyro_bias_rad_s = 0.02;
  double min_turn_rad = 0.3;  ///< of the whole drive, to judge the gyro
  double max_pair_s = 2.0;    ///< between two images that are compared with each other

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// A camera, and what its fixes say of it.
struct ObservedCamera {
  CameraEstimate estimate;
  double off_px = 0.0;  ///< LargestDisplacementPx of its errors
  double view_m = 0.0;  ///< shorter side of the visible floor
  Readout readout;      ///< as its calibration tells it

  static ObservedCamera Of(const CameraEstimate& estimate, double off_px, const FloorCamera& camera);
};

/// Judges a robot by a drive in a map: one finding or more for each part that the record has; for the gyro only with a
/// fit. Throws std::invalid_argument when the options do not pass Check().
std::vector<Finding> Diagnose(const DriveRecord& record, const ObservedCamera& camera,
                              const std::optional<GyroFit>& gyro, const DiagnosisOptions& options = {});

}  // namespace floorloc
