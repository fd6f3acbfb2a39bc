// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/map/floor_map.h"
#include "core/vision/matching/descriptor_index.h"

namespace floorloc {

/// When a floor counts as self-similar. All chosen in 2407dfd; `./run bench honesty` has floors of both kinds.
struct SelfSimilarityOptions {
  int sample = 400;    ///< keypoints that are tested
  int neighbours = 8;  ///< nearest neighbours of each that may be duplicates
  /// Least distance of a duplicate, metres: nearer ones are the same floor point with another descriptor.
  double min_distance_m = 0.05;
  /// Largest share of differing bits of a duplicate: as much as good views of one point differ.
  double max_bit_share = 18.0 / 256.0;
  double min_duplicate_share = 0.5;  ///< share of the sample with a duplicate above which the floor is self-similar

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// A keypoint of a map and those whose descriptors are like its own, itself among them.
struct SimilarKeypoints {
  std::size_t keypoint = 0;
  std::vector<Neighbour> similar;
};

/// A search for similar keypoints.
struct SimilaritySearch {
  int sample = 0;              ///< keypoints, taken at random
  int count = 0;               ///< nearest descriptors of each
  double max_bit_share = 0.0;  ///< largest share of bits in which they differ
  std::uint32_t seed = 0;
};

/// The map must have keypoints and binary descriptors.
std::vector<SimilarKeypoints> FindSimilarKeypoints(const MapKeypoints& map, const DescriptorIndex& index,
                                                   const SimilaritySearch& search);

/// True when the floor repeats itself, as tiles do: more than min_duplicate_share of a sample of its keypoints have a
/// duplicate, a keypoint at another place whose descriptor is as near as another view of the same point. False for
/// float descriptors, which are not tested.
bool IsSelfSimilar(const MapKeypoints& map, const DescriptorIndex& index, const SelfSimilarityOptions& options,
                   std::uint32_t seed);

}  // namespace floorloc
