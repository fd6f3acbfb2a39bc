// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vision/matching/hamming.h"

namespace floorloc {

/// Linear projection of binary descriptors (bits as +-1) on the directions in which a set of them varies most. Bits of
/// one descriptor are correlated: a few such sums say more, and flip less between two views, than as many single bits.
class DescriptorProjection {
 public:
  static constexpr int kDimensions = 32;
  using Values = std::array<std::int16_t, kDimensions>;

  /// Learns from a sample of the rows. The same descriptors give the same projection.
  explicit DescriptorProjection(const PackedDescriptors& descriptors);

  /// Most variance first, in units common to all dimensions.
  Values Project(const std::uint64_t* words) const;
  /// Variance of each dimension in the sample, decreasing; zero beyond the number of bits.
  const std::array<double, kDimensions>& variances() const { return variances_; }

 private:
  int bytes_ = 0;
  std::array<double, kDimensions> variances_{};
  std::vector<Values> sums_;  // of each value of each half byte
};

/// Rows spread evenly over all, at most max_rows: what is learned from them is deterministic.
std::vector<int> SampleRows(int rows, int max_rows);

}  // namespace floorloc
