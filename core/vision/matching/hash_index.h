// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "core/vision/matching/descriptor_index.h"

namespace floorloc {

/// Approximate search among binary descriptors by one hash table. Keys are signs (and quartiles) of the projections on
/// the map's own principal directions (as in spectral hashing, Weiss et al. 2008); a query looks into `probes` buckets
/// in the order in which its own margins make them likely (Lv et al. 2007) and compares what it finds there.
/// The answers depend on nothing but descriptors and options. A neighbour is missed when its key is not among the
/// probed ones, or by chance in a bucket far larger than the usual ones, of which only a part is compared.
/// Costs 6 to 8 bytes per descriptor besides the descriptors, which it shares with the matrix.
std::unique_ptr<DescriptorIndex> CreateHashIndex(const cv::Mat& descriptors, const IndexOptions& options);

}  // namespace floorloc
