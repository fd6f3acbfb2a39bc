// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vision/matching/hamming.h"

namespace floorloc {

/// Linear projection of binary descriptors (bits as +-1) onto their principal components. Bits of one descriptor are
/// correlated: a few such sums carry more information than as many single bits and change less between two views.
class DescriptorProjection {
 public:
  static constexpr int kDimensions = 32;
  using Values = std::array<std::int16_t, kDimensions>;

  /// Learns from a sample of the rows. The same descriptors give the same projection.
  explicit DescriptorProjection(const PackedDescriptors& descriptors);

  /// Largest variance first; the same unit for all dimensions.
  Values Project(const std::uint64_t* words) const;
  /// Variance of each dimension in the sample, decreasing; zero beyond the number of bits.
  const std::array<double, kDimensions>& variances() const { return variances_; }

 private:
  int bytes_ = 0;
  std::array<double, kDimensions> variances_{};
  std::vector<Values> sums_;  // partial sums for each value of each half byte
};

/// At most max_rows rows, spread evenly, so that learning from them is deterministic.
std::vector<int> SampleRows(int rows, int max_rows);

}  // namespace floorloc
