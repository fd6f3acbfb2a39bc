// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "core/vision/matching/descriptor_index.h"

namespace floorloc {

/// Exact search over all descriptors (CV_8U: Hamming, CV_32F: Euclidean).
std::unique_ptr<DescriptorIndex> CreateBruteForceIndex(const cv::Mat& descriptors);

}  // namespace floorloc
