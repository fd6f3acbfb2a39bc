// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/types.hpp>

#include "core/vision/image/box_sampler.h"

namespace floorloc {

/// Dominant direction of the Haar wavelets within 6 s of the keypoint (s its scale), degrees clockwise from the image's
/// right, 0 to 360. Wavelets that would leave the image are shifted into it.
float SurfOrientation(const cv::KeyPoint& keypoint, BoxSampler* sampler);

}  // namespace floorloc
