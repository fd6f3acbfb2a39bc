// SPDX-License-Identifier: Apache-2.0
#include "core/vision/hamming.h"

#include <cstring>

// One source, several instruction sets: the loader picks the widest that the processor has. Sanitizers run before the
// loader's resolvers may, so their builds take the portable path.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define FLOORLOC_MULTIVERSION __attribute__((target_clones("arch=icelake-server", "popcnt", "default")))
#else
#define FLOORLOC_MULTIVERSION
#endif

namespace floorloc {
namespace {

inline void Consider(int index, int distance, TwoNearest* best) {
  if (distance < best->distance) {
    best->second_distance = best->distance;
    best->second_index = best->index;
    best->distance = distance;
    best->index = index;
  } else if (distance < best->second_distance) {
    best->second_distance = distance;
    best->second_index = index;
  }
}

inline int Distance(const std::uint64_t* a, const std::uint64_t* b, int words) {
  int distance = 0;
  for (int w = 0; w < words; ++w) {
    distance += __builtin_popcountll(a[w] ^ b[w]);
  }
  return distance;
}

inline int Distance256(const std::uint64_t* a, const std::uint64_t* b) {
  return __builtin_popcountll(a[0] ^ b[0]) + __builtin_popcountll(a[1] ^ b[1]) + __builtin_popcountll(a[2] ^ b[2]) +
         __builtin_popcountll(a[3] ^ b[3]);
}

constexpr int kWords256 = 4;

FLOORLOC_MULTIVERSION void ScanAll(const std::uint64_t* train, int rows, int words, const std::uint64_t* query,
                                   TwoNearest* best) {
  if (words == kWords256) {
    for (int i = 0; i < rows; ++i) {
      Consider(i, Distance256(train + static_cast<std::ptrdiff_t>(i) * kWords256, query), best);
    }
    return;
  }
  for (int i = 0; i < rows; ++i) {
    Consider(i, Distance(train + static_cast<std::ptrdiff_t>(i) * words, query, words), best);
  }
}

FLOORLOC_MULTIVERSION void ScanSome(const std::uint64_t* train, int words, const std::uint64_t* query,
                                    std::span<const int> candidates, TwoNearest* best) {
  for (const int i : candidates) {
    const std::uint64_t* row = train + static_cast<std::ptrdiff_t>(i) * words;
    Consider(i, words == kWords256 ? Distance256(row, query) : Distance(row, query, words), best);
  }
}

}  // namespace

PackedDescriptors::PackedDescriptors(const cv::Mat& descriptors)
    : rows_(descriptors.rows), words_per_row_((descriptors.cols + 7) / 8) {
  words_.assign(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(words_per_row_), 0);
  for (int i = 0; i < rows_; ++i) {
    std::memcpy(words_.data() + static_cast<std::ptrdiff_t>(i) * words_per_row_, descriptors.ptr(i),
                static_cast<std::size_t>(descriptors.cols));
  }
}

int HammingDistance(const PackedDescriptors& train, int row, const std::uint64_t* query) {
  return Distance(train.row(row), query, train.words_per_row());
}

TwoNearest FindTwoNearest(const PackedDescriptors& train, const std::uint64_t* query) {
  TwoNearest best;
  if (train.rows() > 0) {
    ScanAll(train.row(0), train.rows(), train.words_per_row(), query, &best);
  }
  return best;
}

TwoNearest FindTwoNearest(const PackedDescriptors& train, const std::uint64_t* query, std::span<const int> candidates) {
  TwoNearest best;
  if (!candidates.empty()) {
    ScanSome(train.row(0), train.words_per_row(), query, candidates, &best);
  }
  return best;
}

}  // namespace floorloc
