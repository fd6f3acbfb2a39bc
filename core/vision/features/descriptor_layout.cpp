// SPDX-License-Identifier: Apache-2.0
#include "core/vision/features/descriptor_layout.h"

#include <stdexcept>

namespace floorloc {

std::string ToString(const DescriptorLayout& layout) {
  return std::to_string(layout.length) + (layout.type == DescriptorType::kBinary ? " bytes" : " numbers");
}

DescriptorLayout LayoutOf(const cv::Mat& descriptors) {
  if (descriptors.type() != CV_8UC1 && descriptors.type() != CV_32FC1) {
    throw std::invalid_argument("descriptors must be rows of bytes or of floats");
  }
  return {descriptors.type() == CV_8UC1 ? DescriptorType::kBinary : DescriptorType::kFloat, descriptors.cols};
}

void CheckComparable(const cv::Mat& queries, const DescriptorLayout& train) {
  if (queries.rows == 0 || train.length == 0) {
    return;
  }
  if (const DescriptorLayout layout = LayoutOf(queries); layout != train) {
    throw std::invalid_argument("descriptors of " + ToString(layout) + " can't be compared with descriptors of " +
                                ToString(train) + "; take one extractor for both");
  }
}

}  // namespace floorloc
