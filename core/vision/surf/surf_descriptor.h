// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/types.hpp>

#include "core/vision/image/box_sampler.h"

namespace floorloc {

/// Writes the kSurfLength numbers of the keypoint's descriptor, length 1 (all 0 on an image without any contrast): for
/// each of 4 x 4 fields of 5 s side, rotated by the keypoint's angle, the sums of the Haar wavelets along and across
/// the angle and of their absolute values.
void DescribeSurf(const cv::KeyPoint& keypoint, BoxSampler* sampler, float* descriptor);

}  // namespace floorloc
