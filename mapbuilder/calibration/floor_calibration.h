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

/// A board that lies on the floor, face up, in an image.
struct BoardOnFloorObservation {
  std::string name;
  BoardView view;
  Pose2 base_from_board;  ///< where its corner 0 is and where its x axis points
  Eigen::Isometry3d camera_from_board = Eigen::Isometry3d::Identity();  ///< a first guess
};

struct FloorCalibrationInput {
  CameraModel camera;
  Board board;
  double board_thickness_m = 0.0;  ///< the printed face lies this high above the floor
  std::vector<BoardOnFloorObservation> observations;
};

/// How the corners of one image agree with the camera's pose.
struct FloorFit {
  std::string name;
  double rms_px = 0.0;
  double rms_m = 0.0;  ///< on the board's face, between where a corner is seen and where the board's pose says
  double max_m = 0.0;
  std::vector<Eigen::Vector2d> expected_px;  ///< raw pixels where the corners would be if all agreed
};

struct FloorCalibration {
  Eigen::Isometry3d base_from_camera = Eigen::Isometry3d::Identity();  ///< z of the base frame: up, 0 on the floor
  Eigen::Matrix3d base_from_pixel = Eigen::Matrix3d::Identity();       ///< as in FloorPlane
  std::vector<FloorFit> fits;

  /// Angle between the optical axis and the floor; pi/2: straight down.
  double PitchDownRad() const;
};

/// The camera's pose over the floor by least squares of the reprojection errors of all corners of all observations. Six
/// numbers, not the eight of a free homography: the lens is known, and the plane reaches farther than the board.
FloorCalibration CalibrateFloor(const FloorCalibrationInput& input);

}  // namespace floorloc
