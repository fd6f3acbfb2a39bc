// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vision/matching/descriptor_index.h"
#include "core/vision/matching/hamming.h"

namespace floorloc {

/// Keeps the smallest distances, nearest first; of equal ones those added first.
class NearestList {
 public:
  explicit NearestList(const NeighbourSearch& search)
      : count_(static_cast<std::size_t>(search.count)), max_distance_(search.max_distance) {}

  void Consider(int index, float distance) {
    if (distance > max_distance_) {
      return;
    }
    const auto place = std::upper_bound(list_.begin(), list_.end(), distance,
                                        [](float d, const Neighbour& n) { return d < n.distance; });
    if (place == list_.end() && list_.size() >= count_) {
      return;
    }
    list_.insert(place, {index, distance});
    if (list_.size() > count_) {
      list_.pop_back();
    }
  }
  std::vector<Neighbour>& list() { return list_; }

 private:
  std::size_t count_;
  float max_distance_;
  std::vector<Neighbour> list_;
};

/// Converts the two nearest to a list, for searches of one or two neighbours.
std::vector<Neighbour> ToNeighbours(const TwoNearest& nearest, const NeighbourSearch& search);

/// The nearest candidate rows.
std::vector<Neighbour> NearestHamming(const PackedDescriptors& train, const std::uint64_t* query,
                                      std::span<const int> candidates, const NeighbourSearch& search);

}  // namespace floorloc
