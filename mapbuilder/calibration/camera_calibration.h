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

/// A board seen in an image.
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
  /// Empty: plumb_bob, equidistant or rational_polynomial, whichever explains the views with the fewest coefficients
  /// (Bayesian information criterion).
  std::optional<DistortionModel> model = DistortionModel::kPlumbBob;
  /// An image is left out when its reprojection error is this many times the median of all ...
  double max_error_ratio = 4.0;
  double max_error_floor_px = 0.3;  ///< ... and more than this
};

/// How an image agrees with the calibrated camera.
struct ViewFit {
  std::string name;
  bool used = true;  ///< false: an outlier, left out
  Eigen::Isometry3d camera_from_board = Eigen::Isometry3d::Identity();
  double rms_px = 0.0;
  double max_px = 0.0;
};

struct CameraCalibration {
  CameraModel camera;
  /// Standard deviations in the order and the units of LensParameters, from the residuals; empty when the images
  /// leave a parameter open.
  std::optional<LensCovariance> covariance;
  double rms_px = 0.0;  ///< over the images used: root mean square of the corners' distances
  std::vector<ViewFit> views;

  double SigmaPx(int lens_parameter) const;  ///< of fx, fy, cx, cy (0 to 3); infinite without a covariance
  int used_count() const;
};

/// Least squares over all corners of all images: lens and poses of the boards. Images that disagree with the
/// others are left out. plumb_bob's k3 is 0 unless the images demand and fix it.
/// Throws InputError when there are fewer than 3 images, or when they fit no camera.
CameraCalibration CalibrateCamera(const CameraCalibrationInput& input, const CameraCalibrationOptions& options);

}  // namespace floorloc
