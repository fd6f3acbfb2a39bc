// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "core/vision/matching/descriptor_index.h"

namespace floorloc {

/// Approximate search by FLANN: randomised kd-trees (Muja & Lowe 2009) for float descriptors, hierarchical clusterings
/// (Muja & Lowe 2012) for binary ones.
std::unique_ptr<DescriptorIndex> CreateFlannIndex(const cv::Mat& descriptors, const IndexOptions& options);

}  // namespace floorloc
