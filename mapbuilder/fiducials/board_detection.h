// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "mapbuilder/fiducials/board.h"

namespace floorloc {

/// Finds the board in an image (CV_8UC1), its corners to a few hundredths of a pixel, numbered as Board says. A
/// chessboard must be seen whole, of a ChArUco board at least 6 corners that do not lie in one row. Empty when it isn't
/// there.
std::optional<BoardView> DetectBoard(const cv::Mat& gray, const Board& board);

}  // namespace floorloc
