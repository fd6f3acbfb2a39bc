// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

namespace floorloc {

/// Picks at most max_count keypoints, the strongest of each cell first, so that one high-contrast spot (a lamp, a
/// crack) does not use them all. Returns indices in a deterministic order (cells' first choices, then their second,
/// ...).
std::vector<int> SpreadEvenly(const std::vector<cv::KeyPoint>& keypoints, int cell_px, int max_count);

}  // namespace floorloc
