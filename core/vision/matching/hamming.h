// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "core/vision/matching/hamming_kernels.h"

namespace floorloc {

/// Binary descriptors as 64-bit words (rows padded with zeros), for fast Hamming distances. Movable but not copyable,
/// as they may be large.
class PackedDescriptors {
 public:
  PackedDescriptors() = default;
  /// descriptors: CV_8UC1, one per row. A matrix that owns its memory and whose rows are whole words is shared, not
  /// copied; it must not be modified afterwards.
  explicit PackedDescriptors(const cv::Mat& descriptors);
  PackedDescriptors(PackedDescriptors&&) = default;
  PackedDescriptors& operator=(PackedDescriptors&&) = default;

  int rows() const { return rows_; }
  int words_per_row() const { return words_per_row_; }
  const std::uint64_t* row(int i) const { return words_ + static_cast<std::ptrdiff_t>(i) * words_per_row_; }

 private:
  int rows_ = 0;
  int words_per_row_ = 0;
  const std::uint64_t* words_ = nullptr;  // points into one of the following
  cv::Mat shared_;
  std::vector<std::uint64_t> own_;
};

/// The two smallest Hamming distances of a query among the candidate rows; index -1 when there is none. Of equal
/// distances the first row visited is the nearer one.
struct TwoNearest {
  int index = -1;
  int second_index = -1;
  int distance = 1 << 20;
  int second_distance = 1 << 20;
};

int HammingDistance(const PackedDescriptors& train, int row, const std::uint64_t* query);

/// Among all rows.
TwoNearest FindTwoNearest(const PackedDescriptors& train, const std::uint64_t* query,
                          const HammingKernels& kernels = BestHammingKernels());
/// Among the rows that `candidates` names.
TwoNearest FindTwoNearest(const PackedDescriptors& train, const std::uint64_t* query, std::span<const int> candidates,
                          const HammingKernels& kernels = BestHammingKernels());

/// Calls visit(row, distance) for every candidate, in order. Rows may be scattered in memory: those of the next block
/// are prefetched while this one is compared.
template <typename Visit>
void VisitDistances(const PackedDescriptors& train, const std::uint64_t* query, std::span<const int> candidates,
                    const HammingKernels& kernels, const Visit& visit) {
  constexpr std::size_t kBlock = 128;
  std::array<int, kBlock> distances;
  const auto prefetch = [&](std::size_t first) {
    for (std::size_t i = first; i < std::min(first + kBlock, candidates.size()); ++i) {
      __builtin_prefetch(train.row(candidates[i]));
    }
  };
  prefetch(0);
  for (std::size_t first = 0; first < candidates.size(); first += kBlock) {
    prefetch(first + kBlock);
    const auto block = candidates.subspan(first, std::min(kBlock, candidates.size() - first));
    kernels.chosen({train.row(0), train.words_per_row(), query}, block, distances.data());
    for (std::size_t i = 0; i < block.size(); ++i) {
      visit(block[i], distances[i]);
    }
  }
}

}  // namespace floorloc
