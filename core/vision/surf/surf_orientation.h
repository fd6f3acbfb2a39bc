// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/types.hpp>

#include "core/vision/image/box_sampler.h"

namespace floorloc {

/// The direction in which most Haar wavelets within 6 s of the keypoint point (s its scale), degrees clockwise from the
/// image's right, 0 to 360. Where wavelets would leave the image, its nearest ones count.
float SurfOrientation(const cv::KeyPoint& keypoint, BoxSampler* sampler);

}  // namespace floorloc
