// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/surface/classes/segment_features.h"

namespace floorloc {

/// Fills the group kPattern: rotation-invariant uniform binary patterns of 8 neighbours (LBP riu2 of Ojala, Pietikainen
/// and Maenpaa, PAMI 2002) at radii of 1, 2 and 4 px, the image smoothed for the larger ones; 10 shares per radius.
/// gray: CV_8UC1. A neighbour counts when it is brighter than the centre by at least `threshold` grey levels.
void MeasurePattern(const cv::Mat& gray, const Segmentation& segmentation, int threshold,
                    std::vector<SegmentFeatures>* features);

}  // namespace floorloc
