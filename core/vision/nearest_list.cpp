// SPDX-License-Identifier: Apache-2.0
#include "core/vision/nearest_list.h"

namespace floorloc {

std::vector<Neighbour> ToNeighbours(const TwoNearest& nearest, int count) {
  std::vector<Neighbour> list;
  if (nearest.index >= 0) {
    list.push_back({nearest.index, static_cast<float>(nearest.distance)});
  }
  if (nearest.second_index >= 0 && count > 1) {
    list.push_back({nearest.second_index, static_cast<float>(nearest.second_distance)});
  }
  return list;
}

std::vector<Neighbour> NearestHamming(const PackedDescriptors& train, const std::uint64_t* query,
                                      std::span<const int> candidates, int count) {
  if (count <= 2) {
    return ToNeighbours(FindTwoNearest(train, query, candidates), count);
  }
  NearestList nearest(count);
  for (const int i : candidates) {
    nearest.Consider(i, static_cast<float>(HammingDistance(train, i, query)));
  }
  return std::move(nearest.list());
}

}  // namespace floorloc
