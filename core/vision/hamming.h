// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

namespace floorloc {

/// Binary descriptors packed into 64-bit words (rows padded with zeros), for fast Hamming distances.
class PackedDescriptors {
 public:
  PackedDescriptors() = default;
  /// descriptors: CV_8UC1, one per row.
  explicit PackedDescriptors(const cv::Mat& descriptors);

  int rows() const { return rows_; }
  int words_per_row() const { return words_per_row_; }
  const std::uint64_t* row(int i) const { return words_.data() + static_cast<std::ptrdiff_t>(i) * words_per_row_; }

 private:
  int rows_ = 0;
  int words_per_row_ = 0;
  std::vector<std::uint64_t> words_;
};

/// The two smallest Hamming distances of a query among the candidate rows; index -1 when there is none.
struct TwoNearest {
  int index = -1;
  int second_index = -1;
  int distance = 1 << 20;
  int second_distance = 1 << 20;
};

int HammingDistance(const PackedDescriptors& train, int row, const std::uint64_t* query);

/// Among all rows.
TwoNearest FindTwoNearest(const PackedDescriptors& train, const std::uint64_t* query);
/// Among the rows that `candidates` names.
TwoNearest FindTwoNearest(const PackedDescriptors& train, const std::uint64_t* query, std::span<const int> candidates);

}  // namespace floorloc
