// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/pose2.h"
#include "mapbuilder/fiducials/board.h"

namespace floorloc {

/// Observation of a board lying face up on the floor.
struct BoardOnFloorObservation {
  std::string name;
  BoardView view;
  Pose2 base_from_board;  ///< position of its corner 0 and direction of its x axis
  Eigen::Isometry3d camera_from_board = Eigen::Isometry3d::Identity();  ///< initial value
};

struct FloorCalibrationInput {
  CameraModel camera;
  Board board;
  double board_thickness_m = 0.0;  ///< height of the printed face above the floor
  std::vector<BoardOnFloorObservation> observations;
};

/// Residuals of the corners of one image under the camera's pose.
struct FloorFit {
  std::string name;
  double rms_px = 0.0;
  double rms_m = 0.0;  ///< on the board's face, between the observed corner and the one predicted by the board's pose
  double max_m = 0.0;
  std::vector<Eigen::Vector2d> expected_px;  ///< predicted raw pixels of the corners
};

struct FloorCalibration {
  Eigen::Isometry3d base_from_camera = Eigen::Isometry3d::Identity();  ///< base frame: z up, 0 on the floor
  Eigen::Matrix3d base_from_pixel = Eigen::Matrix3d::Identity();       ///< as in FloorPlane
  std::vector<FloorFit> fits;

  /// Angle between the optical axis and the floor plane; pi/2: straight down.
  double PitchDownRad() const;
};

/// FloorPlane's homography of a camera with this pose in the base frame (optical frame: z forward, x right, y down).
Eigen::Matrix3d BaseFromPixel(const CameraModel& camera, const Eigen::Isometry3d& base_from_camera);

/// Estimates the camera's pose over the floor by least squares on the reprojection errors of all corners of all
/// observations. Six parameters instead of the eight of a free homography, since the lens is known and the plane
/// extends beyond the board.
FloorCalibration CalibrateFloor(const FloorCalibrationInput& input);

}  // namespace floorloc
