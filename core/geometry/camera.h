// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/geometry/readout.h"

namespace floorloc {

/// Lens models of ROS camera_info.
enum class DistortionModel {
  kPlumbBob,            ///< Brown-Conrady: k1 k2 p1 p2 k3 (4 or 5 numbers)
  kRationalPolynomial,  ///< k1 k2 p1 p2 k3 k4 k5 k6 (8 numbers)
  kEquidistant,         ///< Kannala-Brandt fisheye: k1 k2 k3 k4 (4 numbers)
};

const char* ToString(DistortionModel model);

/// A calibrated camera: pinhole plus lens distortion.
/// Pixel convention of OpenCV: (0, 0) is the centre of the top-left pixel, u right, v down.
struct CameraModel {
  std::string name;
  int width_px = 0;
  int height_px = 0;
  double fx = 0.0, fy = 0.0;  ///< focal lengths, px
  double cx = 0.0, cy = 0.0;  ///< principal point, px
  DistortionModel distortion_model = DistortionModel::kPlumbBob;
  std::vector<double> distortion;  ///< coefficients in the order of the model
  /// Standard deviation of the calibration at the corners of the region of interest, px; 0: unknown.
  double sigma_px = 0.0;
  Readout readout = {};

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;

  /// Undistorted pixel (a pinhole camera with the same fx, fy, cx, cy) -> raw pixel.
  Eigen::Vector2d Distort(const Eigen::Vector2d& undistorted_px) const;

  /// Raw pixel -> undistorted pixel; inverse of Distort. NaN where the lens model has no inverse.
  Eigen::Vector2d Undistort(const Eigen::Vector2d& raw_px) const;

  bool Contains(const Eigen::Vector2d& raw_px) const;
};

}  // namespace floorloc
