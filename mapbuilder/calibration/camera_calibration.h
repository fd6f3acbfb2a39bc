// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/camera.h"
#include "mapbuilder/calibration/lens_adjustment.h"
#include "mapbuilder/fiducials/board.h"

namespace floorloc {

/// The board's corners in an image.
struct NamedView {
  std::string name;
  BoardView view;
};

struct CameraCalibrationInput {
  Board board;
  int width_px = 0;
  int height_px = 0;
  std::vector<NamedView> views;
};

struct CameraCalibrationOptions {
  /// Empty: selects plumb_bob, equidistant or rational_polynomial by the Bayesian information criterion.
  std::optional<DistortionModel> model = DistortionModel::kPlumbBob;
  /// An image is an outlier when its reprojection error is this many times the median of all ...
  double max_error_ratio = 4.0;
  double max_error_floor_px = 0.3;  ///< ... and more than this

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Fit of an image to the calibrated camera.
struct ViewFit {
  std::string name;
  bool used = true;  ///< false: outlier
  Eigen::Isometry3d camera_from_board = Eigen::Isometry3d::Identity();
  double rms_px = 0.0;
  double max_px = 0.0;
};

struct CameraCalibration {
  CameraModel camera;
  /// Covariance in the order and units of LensParameters, estimated from the residuals; empty when the images do not
  /// determine a parameter.
  std::optional<LensCovariance> covariance;
  double rms_px = 0.0;  ///< RMS distance of the corners over the images used
  std::vector<ViewFit> views;

  double SigmaPx(int lens_parameter) const;  ///< of fx, fy, cx, cy (0 to 3), px; infinite without a covariance
  int used_count() const;
};

/// Estimates lens and board poses by least squares over all corners of all images, excluding outlier images.
/// plumb_bob's k3 stays 0 unless it is significant and well determined. Throws InputError when there are fewer than 3
/// images, or when they fit no camera.
CameraCalibration CalibrateCamera(const CameraCalibrationInput& input, const CameraCalibrationOptions& options);

}  // namespace floorloc
