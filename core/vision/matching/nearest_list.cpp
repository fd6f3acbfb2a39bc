// SPDX-License-Identifier: Apache-2.0
#include "core/vision/matching/nearest_list.h"

namespace floorloc {

std::vector<Neighbour> ToNeighbours(const TwoNearest& nearest, const NeighbourSearch& search) {
  NearestList list(search);
  if (nearest.index >= 0) {
    list.Consider(nearest.index, static_cast<float>(nearest.distance));
  }
  if (nearest.second_index >= 0) {
    list.Consider(nearest.second_index, static_cast<float>(nearest.second_distance));
  }
  return std::move(list.list());
}

std::vector<Neighbour> NearestHamming(const PackedDescriptors& train, const std::uint64_t* query,
                                      std::span<const int> candidates, const NeighbourSearch& search) {
  if (search.count <= 2) {
    return ToNeighbours(FindTwoNearest(train, query, candidates), search);
  }
  NearestList nearest(search);
  VisitDistances(train, query, candidates, BestHammingKernels(),
                 [&nearest](int row, int distance) { nearest.Consider(row, static_cast<float>(distance)); });
  return std::move(nearest.list());
}

}  // namespace floorloc
