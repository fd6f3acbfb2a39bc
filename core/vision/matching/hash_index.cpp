// SPDX-License-Identifier: Apache-2.0
#include "core/vision/matching/hash_index.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>

#include "core/vision/features/descriptor_layout.h"
#include "core/vision/matching/hamming.h"
#include "core/vision/matching/hash_key.h"
#include "core/vision/matching/nearest_list.h"
#include "core/vision/matching/probe_sequence.h"

namespace floorloc {
namespace {

// Buckets hold 1 to 2 descriptors on average.
int KeyBits(int rows) { return std::clamp(static_cast<int>(std::bit_width(static_cast<unsigned>(rows))) - 1, 0, 30); }

// Of larger buckets only every n-th descriptor is compared: on self-similar floors thousands are equal.
constexpr std::size_t kMaxPerBucket = 64;

// Rows that are always copied from a bucket, even if it has fewer.
constexpr std::size_t kCopied = 8;

void Prefetch(const void* address) { __builtin_prefetch(address); }

// Rows by key, in compressed sparse row form.
class BucketTable {
 public:
  BucketTable(const PackedDescriptors& descriptors, const HashKey& key) {
    std::vector<std::uint32_t> keys(static_cast<std::size_t>(descriptors.rows()));
    start_.assign((std::size_t{1} << key.bits()) + 1, 0);
    for (std::size_t i = 0; i < keys.size(); ++i) {
      keys[i] = key.KeyOf(descriptors.row(static_cast<int>(i)));
      ++start_[keys[i]];
    }
    std::uint32_t sum = 0;
    for (std::uint32_t& start : start_) {
      sum += start;
      start = sum;
    }
    // Filling backwards turns each bucket's end into its start.
    rows_.resize(keys.size() + kCopied);
    for (std::size_t i = keys.size(); i-- > 0;) {
      rows_[--start_[keys[i]]] = static_cast<int>(i);
    }
  }

  void PrefetchStart(std::uint32_t key) const { Prefetch(start_.data() + key); }
  std::span<const int> Bucket(std::uint32_t key) const {
    return {rows_.data() + start_[key], rows_.data() + start_[key + 1]};
  }
  // Writes the bucket's rows to `out`, which has room for kMaxPerBucket + kCopied, and returns how many.
  static std::size_t Copy(std::span<const int> bucket, int* out) {
    std::copy_n(bucket.data(), kCopied, out);  // avoids a branch on the size; few buckets are larger
    if (bucket.size() <= kCopied) {
      return bucket.size();
    }
    const std::size_t step = (bucket.size() + kMaxPerBucket - 1) / kMaxPerBucket;
    std::size_t count = 0;
    for (std::size_t i = 0; i < bucket.size(); i += step) {
      out[count++] = bucket[i];
    }
    return count;
  }

 private:
  std::vector<std::uint32_t> start_;
  std::vector<int> rows_;
};

class HashIndex final : public DescriptorIndex {
 public:
  HashIndex(const cv::Mat& descriptors, const IndexOptions& options)
      : layout_(LayoutOf(descriptors)),
        train_(descriptors),
        key_(train_, KeyBits(train_.rows())),
        table_(train_, key_),
        sequence_(key_.parts(), kMaxProbes),
        probes_(options.probes) {}

  std::vector<std::vector<Neighbour>> Search(const cv::Mat& descriptors, const NeighbourSearch& search) const override {
    CheckComparable(descriptors, layout_);
    const PackedDescriptors queries(descriptors);
    const std::span<const ProbeSequence::Probe> probes = ProbesOf(search);
    std::vector<std::vector<Neighbour>> neighbours(static_cast<std::size_t>(queries.rows()));
    Scratch scratch(probes.size());
    for (int q = 0; q < queries.rows(); ++q) {
      const std::span<const int> candidates = CollectCandidates(queries.row(q), probes, &scratch);
      neighbours[static_cast<std::size_t>(q)] = NearestHamming(train_, queries.row(q), candidates, search);
    }
    return neighbours;
  }
  int size() const override { return train_.rows(); }

 private:
  struct Scratch {
    explicit Scratch(std::size_t probes) : keys(probes), candidates(probes * kMaxPerBucket + kCopied) {}

    std::vector<std::uint32_t> keys;
    std::vector<int> candidates;
  };

  std::span<const ProbeSequence::Probe> ProbesOf(const NeighbourSearch& search) const {
    const auto wanted = static_cast<std::size_t>(search.probes > 0 ? search.probes : probes_);
    return std::span(sequence_.probes()).first(std::clamp<std::size_t>(wanted, 1, sequence_.probes().size()));
  }

  // In passes over several probes, so that their cache misses overlap.
  std::span<const int> CollectCandidates(const std::uint64_t* query, std::span<const ProbeSequence::Probe> probes,
                                         Scratch* scratch) const {
    constexpr std::size_t kBatchSize = 128;
    std::array<std::span<const int>, kBatchSize> buckets;
    const HashKey::Uncertain uncertain = key_.UncertainKeyOf(query);
    std::size_t count = 0;
    for (std::size_t first = 0; first < probes.size(); first += kBatchSize) {
      const std::size_t end = std::min(first + kBatchSize, probes.size());
      for (std::size_t i = first; i < end; ++i) {
        const std::uint32_t parent = i == 0 ? uncertain.key : scratch->keys[probes[i].parent];
        scratch->keys[i] = i == 0 ? parent : parent ^ uncertain.changes[probes[i].rank];
        table_.PrefetchStart(scratch->keys[i]);
      }
      for (std::size_t i = first; i < end; ++i) {
        buckets[i - first] = table_.Bucket(scratch->keys[i]);
        Prefetch(buckets[i - first].data());
      }
      for (std::size_t i = first; i < end; ++i) {
        count += BucketTable::Copy(buckets[i - first], scratch->candidates.data() + count);
      }
    }
    return std::span(scratch->candidates).first(count);
  }

  DescriptorLayout layout_;
  PackedDescriptors train_;
  HashKey key_;
  BucketTable table_;
  ProbeSequence sequence_;
  int probes_;
};

}  // namespace

std::unique_ptr<DescriptorIndex> CreateHashIndex(const cv::Mat& descriptors, const IndexOptions& options) {
  return std::make_unique<HashIndex>(descriptors, options);
}

}  // namespace floorloc
