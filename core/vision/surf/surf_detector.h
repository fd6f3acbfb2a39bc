// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

#include "core/vision/image/integral_image.h"
#include "core/vision/surf/surf.h"

namespace floorloc {

/// Maxima of the determinant of the Hessian over position and scale (Fast-Hessian), to a fraction of a pixel and of a
/// scale, octave by octave and from top to bottom in each layer; see Surf for the keypoints' fields. Angles are -1.
std::vector<cv::KeyPoint> DetectFastHessian(const IntegralImage& integral, const SurfOptions& options);

}  // namespace floorloc
