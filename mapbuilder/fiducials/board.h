// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace floorloc {

/// Markers in the white squares of a chessboard, which identify the visible part of the board.
struct CharucoPattern {
  std::string dictionary;  ///< one of ArucoDictionaryNames()
  double marker_m = 0.0;   ///< side of a marker's black square
};

/// A flat calibration board. Its frame is on its printed face with z out of the print, i.e. x to y is counter-clockwise
/// seen from above. Corner 0 is the origin; corner row * columns + column is at (column * square_m, row * square_m).
/// Chessboard: the square diagonally outside corner 0 is black, which makes the origin unique if one of columns and
/// rows is odd and the other even. ChArUco: with the markers upright, corner 0 is the lower left one and x points
/// right.
struct Board {
  int columns = 0;  ///< inner corners along x
  int rows = 0;     ///< inner corners along y
  double square_m = 0.0;
  std::optional<CharucoPattern> charuco;

  /// Throws std::invalid_argument when a field is invalid.
  void Check() const;

  int corner_count() const { return columns * rows; }
  Eigen::Vector2d Corner(int index) const {
    const int row = index / columns;
    return {index % columns * square_m, row * square_m};
  }
  /// False for a board with 180 degree symmetry: usable for a lens, but not for a pose on the floor.
  bool HasUniqueOrigin() const { return charuco.has_value() || (columns + rows) % 2 == 1; }
};

/// Detected corners of a board in an image; a ChArUco board may be partly visible.
struct BoardView {
  std::vector<int> corners;             ///< indices into the board
  std::vector<Eigen::Vector2d> raw_px;  ///< their positions
};

}  // namespace floorloc
