// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/map/floor_map.h"
#include "core/vision/matching/descriptor_index.h"

namespace floorloc {

/// When a floor counts as one that repeats itself. All from 2407dfd; `./run bench honesty` shows both kinds of floors.
struct SelfSimilarityOptions {
  int sample = 400;    ///< keypoints that are looked up
  int neighbours = 8;  ///< of each that may be its twin
  /// A twin is at least this far away, metres: not the same point in another descriptor.
  double min_distance_m = 0.05;
  /// Share of differing bits up to which descriptors are twins: as much as good views of one point differ.
  double max_bit_share = 18.0 / 256.0;
  double min_twin_share = 0.5;  ///< share of the sample with a twin above which the floor repeats itself

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// True when the floor repeats itself, as tiles do: half of its keypoints, by a sample, have a match at another place
/// whose descriptor is as near as another view of the same point. Binary descriptors; float ones are not tested: false.
bool IsSelfSimilar(const MapKeypoints& map, const DescriptorIndex& index, const SelfSimilarityOptions& options,
                   std::uint32_t seed);

}  // namespace floorloc
