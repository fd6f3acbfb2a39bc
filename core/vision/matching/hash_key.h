// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/vision/matching/descriptor_projection.h"

namespace floorloc {

/// Keys of a hash table for binary descriptors: each of the strongest projections, cut into two or four equally filled
/// cells, gives one or two bits.
class HashKey {
 public:
  /// bits: at most 30; fewer are used when the descriptors vary in fewer dimensions.
  HashKey(const PackedDescriptors& descriptors, int bits);

  int bits() const { return bits_; }
  int parts() const { return static_cast<int>(parts_.size()); }
  std::uint32_t KeyOf(const std::uint64_t* words) const;

  /// The key, and for each of its parts the change of the key to the neighbouring cell, nearest cell first.
  struct Uncertain {
    std::uint32_t key = 0;
    std::array<std::uint32_t, DescriptorProjection::kDimensions> changes{};  ///< XORed with the key; parts() of them
  };
  Uncertain UncertainKeyOf(const std::uint64_t* words) const;

 private:
  // One quantized projection: two bits have three thresholds, one bit has only the middle one.
  struct Part {
    int shift = 0;
    int bits = 0;
    std::array<std::int16_t, 3> thresholds{};

    int CellOf(int value) const;
    std::uint32_t InKey(int cell) const { return static_cast<std::uint32_t>(cell) << shift; }
  };

  void AllocateBits(int bits);
  void LearnThresholds(const PackedDescriptors& descriptors);

  DescriptorProjection projection_;
  std::vector<Part> parts_;  // part i is of dimension i
  int bits_ = 0;
};

}  // namespace floorloc
