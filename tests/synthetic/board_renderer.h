// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/geometry/camera.h"
#include "mapbuilder/fiducials/board.h"

namespace floorloc {

/// A printed board seen from above, the board's y up. Its edges lie on pixel borders.
struct PrintedBoard {
  cv::Mat gray;  ///< CV_8UC1
  double resolution_m = 0.0;
  Eigen::Vector2d corner0_px =
      Eigen::Vector2d::Zero();  ///< corner 0, pixels from the image's upper left edge (not from a pixel centre)
};

/// A chessboard with a white rim of one square. The square's side must be a multiple of 0.5 mm.
PrintedBoard PrintChessboard(const Board& board);
/// A ChArUco board. black_first: the upper left square is black, else the lower left one.
PrintedBoard PrintCharuco(const Board& board, bool black_first);

/// Renders images of a board with lens distortion, integrated over each pixel's area. The background is a grey ramp.
class BoardRenderer {
 public:
  explicit BoardRenderer(const CameraModel& camera);

  cv::Mat Render(const PrintedBoard& board, const Eigen::Isometry3d& camera_from_board) const;

 private:
  CameraModel camera_;
  std::vector<Eigen::Vector2d> rays_;  // on z = 1, through the corners of all pixels: (width + 1) x (height + 1)
};

/// Pose of a board in front of the camera: its centre on the ray through pixel `middle_px` (undistorted) at distance_m,
/// rotated about its own x and y axes (tilt) and about its normal.
struct BoardPlacement {
  Eigen::Vector2d middle_px = Eigen::Vector2d::Zero();
  double distance_m = 0.5;
  double tilt_x_rad = 0.0;
  double tilt_y_rad = 0.0;
  double turn_rad = 0.0;
};
Eigen::Isometry3d PlaceBoard(const CameraModel& camera, const Board& board, const BoardPlacement& placement);

/// Placements that constrain all camera parameters: all over the image, near and far, tilted to all sides.
std::vector<BoardPlacement> VariedPlacements(const CameraModel& camera, const Board& board, int count);

/// Projections of the board's corners that are inside the image, with Gaussian noise, in the board's order.
BoardView ProjectBoard(const CameraModel& camera, const Board& board, const Eigen::Isometry3d& camera_from_board,
                       double noise_px, unsigned seed);

/// 480x360, wide-angle, plumb_bob.
CameraModel MakeBoardCamera();

}  // namespace floorloc
