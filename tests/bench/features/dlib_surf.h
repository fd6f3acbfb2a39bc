// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/bench/features/feature_method.h"

namespace floorloc {

/// The strongest of dlib's SURF features (4 octaves of 4 scales, initial sampling step 2 px), in Surf's keypoint
/// format.
ImageFeatures DlibSurf(const cv::Mat& gray, double threshold, int max_keypoints);

}  // namespace floorloc
