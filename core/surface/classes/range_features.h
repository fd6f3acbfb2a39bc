// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/surface/classes/segment_features.h"

namespace floorloc {

/// Fills the groups kDepthIntensity and kIntensity of the segments that have depth anywhere, from their pixels that
/// have it. max_intensity: end of the histogram, in the sensor's unit.
void MeasureRange(const SurfaceImage& image, const Segmentation& segmentation, float max_intensity,
                  std::vector<SegmentFeatures>* features);

}  // namespace floorloc
