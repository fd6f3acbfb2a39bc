// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "core/geometry/camera.h"

namespace floorloc {

/// Axis-aligned rectangle in the base frame, metres.
struct RectM {
  double x_min = 0.0, x_max = 0.0;
  double y_min = 0.0, y_max = 0.0;

  double width_m() const { return x_max - x_min; }
  double height_m() const { return y_max - y_min; }
  Eigen::Vector2d Center() const { return {0.5 * (x_min + x_max), 0.5 * (y_min + y_max)}; }
  bool Contains(const Eigen::Vector2d& p) const {
    return p.x() >= x_min && p.x() <= x_max && p.y() >= y_min && p.y() <= y_max;
  }
};

/// The floor relative to the camera: floor.yaml.
struct FloorPlane {
  /// Undistorted pixel (u, v, 1) -> floor point in the base frame (x forward, y left), metres, homogeneous.
  Eigen::Matrix3d base_from_pixel = Eigen::Matrix3d::Identity();
  RectM roi;                  ///< the part of the floor that is used, base frame
  double resolution_m = 0.0;  ///< metres per pixel of the rectified image
  /// Standard deviation of the base frame's place relative to the floor that the camera sees, by the camera's roll and
  /// pitch, metres; 0: unknown.
  double offset_sigma_m = 0.0;

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
};

/// A calibrated camera over the floor: camera.yaml and floor.yaml.
struct FloorCamera {
  CameraModel camera;
  FloorPlane floor;

  /// Checks both parts, and that they match: the homography is not mirrored, the region of interest is in front of the
  /// horizon and at least partly inside the image. Throws std::invalid_argument.
  void Check() const;

  /// The same camera with another resolution: keypoints of a map only match images at the map's resolution.
  FloorCamera AtResolution(double resolution_m) const;

  /// The same camera at another height over the floor, a multiple of its own: floor and region of interest scale about
  /// the point below it. Throws std::invalid_argument unless the ratio is positive.
  FloorCamera AtHeight(double ratio) const;

  /// Position of the camera in the base frame, metres, by decomposition of the homography (Zhang 2000); z is its
  /// height.
  Eigen::Vector3d CameraCenter() const;

  Eigen::Vector2d FloorFromRawPixel(const Eigen::Vector2d& raw_px) const;
  Eigen::Vector2d RawPixelFromFloor(const Eigen::Vector2d& point_in_base_m) const;
};

}  // namespace floorloc
