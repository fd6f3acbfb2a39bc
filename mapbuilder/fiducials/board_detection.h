// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "mapbuilder/fiducials/board.h"

namespace floorloc {

/// Detects the board in an image (CV_8UC1), with corners accurate to a few hundredths of a pixel and numbered as in
/// Board. A chessboard must be fully visible; of a ChArUco board at least 6 corners that are not in one row. Empty if
/// not found.
std::optional<BoardView> DetectBoard(const cv::Mat& gray, const Board& board);

}  // namespace floorloc
