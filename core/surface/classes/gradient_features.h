// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/surface/classes/segment_features.h"

namespace floorloc {

/// Fills the group kGradient: at full, half and quarter size, of the gradients' magnitudes m and directions a: the
/// logarithm of the mean of m, the logarithm of mean(m^2) / mean(m)^2 (few strong edges or many weak ones), the
/// strength of one direction |sum of m^2 e^2ia| / sum of m^2, that of two perpendicular ones (e^4ia), and the share of
/// flat pixels. gray: CV_8UC1.
void MeasureGradient(const cv::Mat& gray, const Segmentation& segmentation, std::vector<SegmentFeatures>* features);

}  // namespace floorloc
