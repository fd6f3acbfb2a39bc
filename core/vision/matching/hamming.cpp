// SPDX-License-Identifier: Apache-2.0
#include "core/vision/matching/hamming.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace floorloc {
namespace {

// Distances computed per block.
constexpr int kBlock = 256;

void Consider(int index, int distance, TwoNearest* best) {
  if (distance >= best->second_distance) {
    return;
  }
  if (distance < best->distance) {
    best->second_distance = best->distance;
    best->second_index = best->index;
    best->distance = distance;
    best->index = index;
  } else {
    best->second_distance = distance;
    best->second_index = index;
  }
}

// Contiguous rows of whole words. (OpenCV does not call matrices beyond 2 GiB continuous.)
bool CanShare(const cv::Mat& m) {
  constexpr std::size_t kWord = sizeof(std::uint64_t);
  const auto row_bytes = static_cast<std::size_t>(m.cols);
  return m.u != nullptr && m.type() == CV_8UC1 && m.step[0] == row_bytes && row_bytes % kWord == 0 &&
         reinterpret_cast<std::uintptr_t>(m.data) % kWord == 0;
}

}  // namespace

PackedDescriptors::PackedDescriptors(const cv::Mat& descriptors)
    : rows_(descriptors.rows), words_per_row_((descriptors.cols + 7) / 8) {
  if (CanShare(descriptors)) {
    shared_ = descriptors;
    words_ = reinterpret_cast<const std::uint64_t*>(shared_.data);
    return;
  }
  own_.assign(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(words_per_row_), 0);
  for (int i = 0; i < rows_; ++i) {
    std::memcpy(own_.data() + static_cast<std::ptrdiff_t>(i) * words_per_row_, descriptors.ptr(i),
                static_cast<std::size_t>(descriptors.cols));
  }
  words_ = own_.data();
}

int HammingDistance(const PackedDescriptors& train, int row, const std::uint64_t* query) {
  int distance = 0;
  for (int w = 0; w < train.words_per_row(); ++w) {
    distance += std::popcount(train.row(row)[w] ^ query[w]);
  }
  return distance;
}

TwoNearest FindTwoNearest(const PackedDescriptors& train, const std::uint64_t* query, const HammingKernels& kernels) {
  TwoNearest best;
  std::array<int, kBlock> distances;
  for (int first = 0; first < train.rows(); first += kBlock) {
    const int count = std::min(kBlock, train.rows() - first);
    kernels.successive({train.row(first), train.words_per_row(), query}, count, distances.data());
    for (int i = 0; i < count; ++i) {
      Consider(first + i, distances[static_cast<std::size_t>(i)], &best);
    }
  }
  return best;
}

TwoNearest FindTwoNearest(const PackedDescriptors& train, const std::uint64_t* query, std::span<const int> candidates,
                          const HammingKernels& kernels) {
  TwoNearest best;
  VisitDistances(train, query, candidates, kernels,
                 [&best](int index, int distance) { Consider(index, distance, &best); });
  return best;
}

}  // namespace floorloc
