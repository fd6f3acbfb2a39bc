// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "core/vision/descriptor_index.h"

namespace floorloc {

/// Approximate search among binary descriptors by multi-index hashing (Norouzi, Punjani & Fleet 2012): each descriptor
/// stands in one hash table per slice of its bits; a query looks up its own slices and those one bit away, and
/// compares only what it finds there. A neighbour is missed when every slice differs in two bits or more.
std::unique_ptr<DescriptorIndex> CreateMihIndex(const cv::Mat& descriptors);

}  // namespace floorloc
