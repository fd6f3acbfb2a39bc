// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/geometry/camera.h"
#include "mapbuilder/fiducials/board.h"

namespace floorloc {

/// A board as it comes out of the printer: seen from above, the board's y up. Its edges fall between pixels.
struct PrintedBoard {
  cv::Mat gray;  ///< CV_8UC1
  double resolution_m = 0.0;
  Eigen::Vector2d corner0_px = Eigen::Vector2d::Zero();  ///< corner 0, in units of pixels from the upper left edge
};

/// A chessboard, with a white rim of one square. Squares must be multiples of 0.5 mm.
PrintedBoard PrintChessboard(const Board& board);
/// A ChArUco board; `black_first`: the upper left square is black, else the one in the lower left.
PrintedBoard PrintCharuco(const Board& board, bool black_first);

/// Images of a board through a lens, integrated over each pixel's area; beside the board a grey ramp.
class BoardRenderer {
 public:
  explicit BoardRenderer(const CameraModel& camera);

  cv::Mat Render(const PrintedBoard& board, const Eigen::Isometry3d& camera_from_board) const;

 private:
  CameraModel camera_;
  std::vector<Eigen::Vector2d> rays_;  // plane z = 1, for the upper left corner of every pixel, one more each way
};

/// A board held before the camera: its middle on the ray through raw pixel `middle_px` (undistorted) at distance_m,
/// tilted about its own x and y axes and turned in its plane.
struct BoardPlacement {
  Eigen::Vector2d middle_px = Eigen::Vector2d::Zero();
  double distance_m = 0.5;
  double tilt_x_rad = 0.0;
  double tilt_y_rad = 0.0;
  double turn_rad = 0.0;
};
Eigen::Isometry3d PlaceBoard(const CameraModel& camera, const Board& board, const BoardPlacement& placement);

/// Places that constrain a camera well: all over the image, near and far, tilted to all sides.
std::vector<BoardPlacement> VariedPlacements(const CameraModel& camera, const Board& board, int count);

/// Where a camera shows the corners of a board that are in its image, with Gaussian noise, in the board's order.
BoardView ProjectBoard(const CameraModel& camera, const Board& board, const Eigen::Isometry3d& camera_from_board,
                       double noise_px, unsigned seed);

/// 480x360 with a wide lens: plumb_bob.
CameraModel MakeBoardCamera();

}  // namespace floorloc
