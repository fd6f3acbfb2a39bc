// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/bench/features/feature_method.h"

namespace floorloc {

/// The strongest of dlib's SURF features (4 octaves of 4 scales, first samples 2 px apart), keypoints as Surf has them.
ImageFeatures DlibSurf(const cv::Mat& gray, double threshold, int max_keypoints);

}  // namespace floorloc
