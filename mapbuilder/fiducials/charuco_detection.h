// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "mapbuilder/fiducials/board.h"

namespace floorloc {

/// Finds the inner corners of a ChArUco board near detected markers (CV_8UC1), without sub-pixel refinement. Supports
/// both layouts for an even number of rows of squares: white upper left square (OpenCV up to 4.6) and black (later
/// versions). Empty when fewer than two markers are detected.
std::optional<BoardView> DetectCharuco(const cv::Mat& gray, const Board& board);

}  // namespace floorloc
