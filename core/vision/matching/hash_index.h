// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "core/vision/matching/descriptor_index.h"

namespace floorloc {

/// Approximate search among binary descriptors by one hash table. Keys are signs (and quartiles) of the projections on
/// the map's own principal directions (as in spectral hashing, Weiss et al. 2008); a query visits `probes` buckets,
/// most likely ones first by its margins (Lv et al. 2007), and compares their descriptors. Deterministic. A neighbour
/// is missed when its key is not among the probed ones, or when it is in a bucket so large that only a part of it is
/// compared. Costs 6 to 8 bytes per descriptor besides the descriptors, which it shares with the matrix.
std::unique_ptr<DescriptorIndex> CreateHashIndex(const cv::Mat& descriptors, const IndexOptions& options);

}  // namespace floorloc
