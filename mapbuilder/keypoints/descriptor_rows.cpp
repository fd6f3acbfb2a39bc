// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/keypoints/descriptor_rows.h"

#include <cmath>

namespace floorloc {
namespace {

double RelativeDistance(const float* a, const float* b, int count) {
  double difference = 0.0;
  double norm = 0.0;
  for (int i = 0; i < count; ++i) {
    const double d = a[i] - b[i];
    difference += d * d;
    norm += static_cast<double>(b[i]) * b[i];
  }
  return std::sqrt(difference / (norm + 1e-18));
}

}  // namespace

DescriptorRows::DescriptorRows(const cv::Mat& descriptors) {
  if (descriptors.depth() == CV_8U) {
    bits_ = PackedDescriptors(descriptors);
    bits_per_row_ = 8.0 * descriptors.cols;
  } else {
    floats_ = descriptors;
  }
}

double DescriptorRows::Difference(const DescriptorRows& a, int row_a, const DescriptorRows& b, int row_b) {
  if (!a.floats_.empty()) {
    return RelativeDistance(a.floats_.ptr<float>(row_a), b.floats_.ptr<float>(row_b), a.floats_.cols);
  }
  int bits = 0;
  const int words = a.bits_.words_per_row();
  BestHammingKernels().successive({b.bits_.row(row_b), words, a.bits_.row(row_a)}, 1, &bits);
  return bits / a.bits_per_row_;
}

}  // namespace floorloc
