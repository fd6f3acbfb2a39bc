// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "core/vision/features/features.h"

namespace floorloc {

/// Type and length of the descriptors of one extractor.
struct DescriptorLayout {
  DescriptorType type = DescriptorType::kBinary;
  int length = 0;  ///< bytes (binary) or numbers (float) per descriptor

  bool operator==(const DescriptorLayout&) const = default;
};

/// "32 bytes", "128 numbers"
std::string ToString(const DescriptorLayout& layout);

/// Layout of a matrix with one descriptor per row. Throws std::invalid_argument when it is neither CV_8UC1 nor
/// CV_32FC1.
DescriptorLayout LayoutOf(const cv::Mat& descriptors);

/// Throws std::invalid_argument when there are queries whose layout differs from `train`: shorter ones would be read
/// beyond their end. train.length 0: there are no train descriptors.
void CheckComparable(const cv::Mat& queries, const DescriptorLayout& train);

}  // namespace floorloc
