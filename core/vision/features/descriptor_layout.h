// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "core/vision/features/features.h"

namespace floorloc {

/// What all descriptors of one extractor have in common.
struct DescriptorLayout {
  DescriptorType type = DescriptorType::kBinary;
  int length = 0;  ///< bytes (binary) or numbers (float) per descriptor

  bool operator==(const DescriptorLayout&) const = default;
};

/// "32 bytes", "128 numbers"
std::string ToString(const DescriptorLayout& layout);

/// Of a matrix with one descriptor per row. Throws std::invalid_argument when it is neither CV_8UC1 nor CV_32FC1.
DescriptorLayout LayoutOf(const cv::Mat& descriptors);

/// Throws std::invalid_argument when there are queries and they can't be compared with descriptors of the layout:
/// a shorter one would be read beyond its end. Length 0 stands for no descriptors at all.
void CheckComparable(const cv::Mat& queries, const DescriptorLayout& train);

}  // namespace floorloc
