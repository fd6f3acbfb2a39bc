// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/features2d.hpp>

#include "core/vision/surf/surf.h"

namespace floorloc {

/// SURF as cv::Feature2D: detect() sets no angles and returns only keypoints that compute() can describe.
/// Throws as Surf does.
cv::Ptr<cv::Feature2D> CreateSurfFeature(const SurfOptions& options);

}  // namespace floorloc
