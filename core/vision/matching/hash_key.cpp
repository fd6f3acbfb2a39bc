// SPDX-License-Identifier: Apache-2.0
#include "core/vision/matching/hash_key.h"

#include <algorithm>
#include <cstdlib>

namespace floorloc {
namespace {

constexpr int kMaxBitsPerPart = 2;
constexpr int kSampleRows = 4096;

// Below this variance a projection is noise.
constexpr double kMinVariance = 1e-3;

}  // namespace

HashKey::HashKey(const PackedDescriptors& descriptors, int bits) : projection_(descriptors) {
  AllocateBits(bits);
  LearnThresholds(descriptors);
}

// Each bit is allocated to the largest remaining variance; a bit halves a projection's spread.
void HashKey::AllocateBits(int bits) {
  std::array<double, DescriptorProjection::kDimensions> left = projection_.variances();
  std::array<int, DescriptorProjection::kDimensions> allocated{};
  for (int bit = 0; bit < bits; ++bit) {
    const auto most = static_cast<std::size_t>(std::max_element(left.begin(), left.end()) - left.begin());
    if (left[most] < kMinVariance) {
      break;
    }
    ++allocated[most];
    left[most] = allocated[most] == kMaxBitsPerPart ? 0.0 : left[most] / 4.0;
  }
  for (const int count : allocated) {
    if (count == 0) {
      break;  // variances decrease, so no later dimension has bits
    }
    parts_.push_back({bits_, count, {}});
    bits_ += count;
  }
}

void HashKey::LearnThresholds(const PackedDescriptors& descriptors) {
  const std::vector<int> rows = SampleRows(descriptors.rows(), kSampleRows);
  std::vector<DescriptorProjection::Values> sample;
  for (const int row : rows) {
    sample.push_back(projection_.Project(descriptors.row(row)));
  }
  std::vector<std::int16_t> values(sample.size());
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    std::transform(sample.begin(), sample.end(), values.begin(), [i](const auto& v) { return v[i]; });
    std::sort(values.begin(), values.end());
    for (std::size_t t = 0; t < 3; ++t) {
      parts_[i].thresholds[t] = values[(t + 1) * values.size() / 4];
    }
  }
}

int HashKey::Part::CellOf(int value) const {
  if (bits == 1) {
    return value > thresholds[1] ? 1 : 0;
  }
  return (value > thresholds[0] ? 1 : 0) + (value > thresholds[1] ? 1 : 0) + (value > thresholds[2] ? 1 : 0);
}

std::uint32_t HashKey::KeyOf(const std::uint64_t* words) const {
  const DescriptorProjection::Values values = projection_.Project(words);
  std::uint32_t key = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    key |= parts_[i].InKey(parts_[i].CellOf(values[i]));
  }
  return key;
}

HashKey::Uncertain HashKey::UncertainKeyOf(const std::uint64_t* words) const {
  struct Change {
    int margin = 0;
    std::uint32_t bits = 0;
  };
  const DescriptorProjection::Values values = projection_.Project(words);
  std::array<Change, DescriptorProjection::kDimensions> changes;
  Uncertain result;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Part& part = parts_[i];
    const int cell = part.CellOf(values[i]);
    const int to_middle = std::abs(values[i] - part.thresholds[1]);
    int margin = to_middle;
    int neighbour = part.bits == 1 ? 1 - cell : 3 - cell;  // across the median: 1 <-> 2
    if (part.bits == 2) {
      const int to_outer = std::abs(values[i] - part.thresholds[cell <= 1 ? 0 : 2]);
      const bool outer = cell == 0 || cell == 3 || to_outer < to_middle;
      margin = outer ? to_outer : to_middle;
      neighbour = outer ? cell ^ 1 : 3 - cell;  // 0 <-> 1, 2 <-> 3
    }
    result.key |= part.InKey(cell);
    changes[i] = {margin, part.InKey(cell ^ neighbour)};
  }
  const auto end = changes.begin() + parts();
  std::sort(changes.begin(), end, [](const Change& a, const Change& b) { return a.margin < b.margin; });
  std::transform(changes.begin(), end, result.changes.begin(), [](const Change& c) { return c.bits; });
  return result;
}

}  // namespace floorloc
