// SPDX-License-Identifier: Apache-2.0
#include "core/vision/mih_index.h"

#include <algorithm>
#include <bit>
#include <span>

#include "core/vision/hamming.h"
#include "core/vision/nearest_list.h"

namespace floorloc {
namespace {

// Slices of about log2(n) bits: a bucket then holds about one descriptor.
int SliceBits(int rows) { return std::clamp(static_cast<int>(std::bit_width(static_cast<unsigned>(rows))), 10, 22); }

std::uint32_t Slice(const std::uint64_t* words, int first_bit, int bits) {
  const int word = first_bit / 64;
  const int shift = first_bit % 64;
  std::uint64_t value = words[word] >> shift;
  if (shift + bits > 64) {
    value |= words[word + 1] << (64 - shift);
  }
  return static_cast<std::uint32_t>(value & ((1ULL << bits) - 1));
}

// One hash table: rows by the value of one slice, in compressed form.
class SliceTable {
 public:
  SliceTable(const PackedDescriptors& descriptors, int first_bit, int bits) : first_bit_(first_bit), bits_(bits) {
    start_.assign((std::size_t{1} << bits) + 1, 0);
    for (int i = 0; i < descriptors.rows(); ++i) {
      ++start_[KeyOf(descriptors.row(i)) + 1];
    }
    for (std::size_t k = 1; k < start_.size(); ++k) {
      start_[k] += start_[k - 1];
    }
    rows_.resize(static_cast<std::size_t>(descriptors.rows()));
    std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
    for (int i = 0; i < descriptors.rows(); ++i) {
      rows_[next[KeyOf(descriptors.row(i))]++] = i;
    }
  }

  std::uint32_t KeyOf(const std::uint64_t* words) const { return Slice(words, first_bit_, bits_); }
  std::span<const int> Bucket(std::uint32_t key) const {
    return {rows_.data() + start_[key], rows_.data() + start_[key + 1]};
  }
  int bits() const { return bits_; }

 private:
  int first_bit_;
  int bits_;
  std::vector<std::uint32_t> start_;
  std::vector<int> rows_;
};

class MihIndex final : public DescriptorIndex {
 public:
  explicit MihIndex(const cv::Mat& descriptors) : train_(descriptors) {
    const int bits = SliceBits(descriptors.rows);
    for (int first = 0; first + bits <= 8 * descriptors.cols; first += bits) {
      tables_.emplace_back(train_, first, bits);
    }
  }

  std::vector<std::vector<Neighbour>> FindNeighbours(const cv::Mat& descriptors, int count) const override {
    const PackedDescriptors queries(descriptors);
    // Rows seen by the current query, so that one found in several tables is compared once.
    std::vector<int> seen(static_cast<std::size_t>(train_.rows()), -1);
    std::vector<int> candidates;
    std::vector<std::vector<Neighbour>> neighbours;
    for (int q = 0; q < queries.rows(); ++q) {
      const std::uint64_t* query = queries.row(q);
      CollectCandidates(query, q, &seen, &candidates);
      neighbours.push_back(NearestHamming(train_, query, candidates, count));
    }
    return neighbours;
  }
  int size() const override { return train_.rows(); }

 private:
  void CollectCandidates(const std::uint64_t* query, int number, std::vector<int>* seen,
                         std::vector<int>* candidates) const {
    candidates->clear();
    const auto take = [&](std::span<const int> bucket) {
      for (const int i : bucket) {
        int& mark = (*seen)[static_cast<std::size_t>(i)];
        if (mark != number) {
          mark = number;
          candidates->push_back(i);
        }
      }
    };
    for (const SliceTable& table : tables_) {
      const std::uint32_t key = table.KeyOf(query);
      take(table.Bucket(key));
      for (int bit = 0; bit < table.bits(); ++bit) {
        take(table.Bucket(key ^ (1U << bit)));
      }
    }
  }

  PackedDescriptors train_;
  std::vector<SliceTable> tables_;
};

}  // namespace

std::unique_ptr<DescriptorIndex> CreateMihIndex(const cv::Mat& descriptors) {
  return std::make_unique<MihIndex>(descriptors);
}

}  // namespace floorloc
