// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "mapbuilder/fiducials/board.h"

namespace floorloc {

/// Finds the inner corners of a ChArUco board near detected markers (CV_8UC1), not yet refined to sub-pixels.
/// Boards with an even number of rows of squares start with a white square in the upper left corner or with a black
/// one, as OpenCV drew them up to version 4.6 and since then: both are known. Empty when fewer than two markers are
/// seen.
std::optional<BoardView> DetectCharuco(const cv::Mat& gray, const Board& board);

}  // namespace floorloc
