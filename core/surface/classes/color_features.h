// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/surface/classes/segment_features.h"

namespace floorloc {

/// Fills the groups kHueSaturation, kValue and kColor. color: CV_8UC3, BGR.
void MeasureColor(const cv::Mat& color, const Segmentation& segmentation, std::vector<SegmentFeatures>* features);

}  // namespace floorloc
