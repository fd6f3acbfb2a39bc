// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/fiducials/board.h"

#include <cmath>
#include <stdexcept>

#include "mapbuilder/fiducials/aruco_dictionary.h"

namespace floorloc {
namespace {

constexpr int kMaxCorners = 100;

void Require(bool ok, const char* message) {
  if (!ok) {
    throw std::invalid_argument(message);
  }
}

}  // namespace

void Board::Check() const {
  Require(columns >= 3 && rows >= 3 && columns <= kMaxCorners && rows <= kMaxCorners,
          charuco ? "a ChArUco board must have 4 to 101 squares on each side; --board counts its squares"
                  : "a chessboard must have 3 to 100 inner corners on each side; --board counts inner corners, which "
                    "are one less than its squares");
  Require(std::isfinite(square_m) && square_m > 1e-4 && square_m < 10.0,
          "the squares must be between 0.1 mm and 10 m wide; --square takes metres");
  if (!charuco) {
    return;
  }
  Require(std::isfinite(charuco->marker_m) && charuco->marker_m > 0.1 * square_m && charuco->marker_m < square_m,
          "the markers of a ChArUco board must be smaller than its squares; --marker and --square take metres");
  const int markers = (columns + 1) * (rows + 1) / 2;
  Require(markers <= FindArucoDictionary(charuco->dictionary)->bytesList.rows,
          "the ChArUco board has more markers than its dictionary; check --board and --charuco");
}

}  // namespace floorloc
