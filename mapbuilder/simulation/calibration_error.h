// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/geometry/floor_plane.h"

namespace floorloc {

/// What a calibration is wrong by. The default is a perfect calibration, which does not exist: a careful one leaves 0.2
/// to 1 px at the image's corners (`floorloc-mapbuilder calibrate` prints what it left).
struct CalibrationError {
  double radial_px = 0.0;           ///< displacement at the farthest corner by k1 (grows with r^3)
  double tangential_px = 0.0;       ///< and by p1, p2 (grows with r^2); not for equidistant lenses
  double principal_point_px = 0.0;  ///< shift of the principal point along the image's diagonal
  double focal_share = 0.0;         ///< relative error of the focal length
  double roll_rad = 0.0;            ///< of the floor homography: rotation of the camera about the base's x axis
  double pitch_rad = 0.0;           ///< and about its y axis
  double height_m = 0.0;            ///< and its height

  /// Lens residual of `residual_px` at the corner, two thirds radial and one third tangential, and a floor homography
  /// off by `tilt_rad` in roll and half of it, with the other sign, in pitch.
  static CalibrationError Typical(double residual_px, double tilt_rad);

  /// Of a recording under the conditions "clean" (none), "mild" or "hard": 0.3 px and 0.1 degrees, since a camera that
  /// is known exactly does not exist.
  static CalibrationError ForCondition(const std::string& name);

  bool IsZero() const;
  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// The calibration that a user of the camera has. Principal point and focal length are wrong in camera.yaml while
/// floor.yaml was measured with them, so only the lens distortion shows them. Throws std::invalid_argument when the
/// lens model cannot have the error.
FloorCamera Miscalibrated(const FloorCamera& camera, const CalibrationError& error);

}  // namespace floorloc
