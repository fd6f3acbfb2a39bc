// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace floorloc {

/// Markers in the white squares of a chessboard, which identify the part of the board in view.
struct CharucoPattern {
  std::string dictionary;  ///< a name of ArucoDictionaryNames()
  double marker_m = 0.0;   ///< side of a marker's black square
};

/// A flat calibration board. Its frame lies on its printed face: z points out of the print, so x turns
/// counter-clockwise to y when seen from above. Corner 0 is the origin; corner row * columns + column is at
/// (column * square_m, row * square_m).
/// Chessboard: the square diagonally outside of corner 0 is black, which leaves one origin when one of columns, rows is
/// odd and the other even. ChArUco: with the markers upright, corner 0 is the lower left one and x runs to the right.
struct Board {
  int columns = 0;  ///< inner corners along x
  int rows = 0;     ///< inner corners along y
  double square_m = 0.0;
  std::optional<CharucoPattern> charuco;

  /// Throws std::invalid_argument with what makes no sense.
  void Check() const;

  int corner_count() const { return columns * rows; }
  Eigen::Vector2d Corner(int index) const { return {index % columns * square_m, index / columns * square_m}; }
  /// False for a board that is symmetric under half a turn: good for a lens, not for a pose on the floor.
  bool HasUniqueOrigin() const { return charuco.has_value() || (columns + rows) % 2 == 1; }
};

/// Positions of the corners of a board in an image; a ChArUco board may be seen in part.
struct BoardView {
  std::vector<int> corners;             ///< indices into the board
  std::vector<Eigen::Vector2d> raw_px;  ///< where they are
};

}  // namespace floorloc
