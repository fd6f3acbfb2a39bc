// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "core/vision/matching/hamming.h"

namespace floorloc {

/// Descriptors of one type, packed for fast comparison. Shares the matrix's memory where possible.
class DescriptorRows {
 public:
  DescriptorRows() = default;
  explicit DescriptorRows(const cv::Mat& descriptors);

  /// Share of differing bits (binary), or distance as a share of b's norm (float); 0: equal.
  static double Difference(const DescriptorRows& a, int row_a, const DescriptorRows& b, int row_b);

 private:
  cv::Mat floats_;
  PackedDescriptors bits_;
  double bits_per_row_ = 1.0;
};

}  // namespace floorloc
