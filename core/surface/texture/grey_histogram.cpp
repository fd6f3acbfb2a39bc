// SPDX-License-Identifier: Apache-2.0
#include "core/surface/texture/grey_histogram.h"

#include <cstring>

#include "core/vision/image/multiversion.h"

namespace floorloc {
namespace {

// Neighbouring pixels are often equal: to count them in one table would wait for each other's stores.
constexpr std::size_t kTables = 8;
using Tables = std::array<std::array<std::uint32_t, kGreyLevels>, kTables>;

void CountRow(const std::uint8_t* row, int width, Tables* tables) {
  int u = 0;
  for (; u + 8 <= width; u += 8) {
    std::uint64_t eight;
    std::memcpy(&eight, row + u, sizeof(eight));
    for (std::size_t i = 0; i < kTables; ++i) {
      ++(*tables)[i][(eight >> (8 * i)) & 0xFF];
    }
  }
  for (; u < width; ++u) {
    ++(*tables)[0][row[u]];
  }
}

}  // namespace

GreyHistogram CountGreyLevels(const GreyPixels& pixels) {
  Tables tables{};
  for (int v = 0; v < pixels.height; ++v) {
    CountRow(pixels.first + static_cast<std::size_t>(v) * pixels.stride, pixels.width, &tables);
  }
  GreyHistogram histogram{};
  for (const auto& table : tables) {
    for (std::size_t level = 0; level < histogram.size(); ++level) {
      histogram[level] += table[level];
    }
  }
  return histogram;
}

FLOORLOC_WIDE_VECTORS
LevelSums SumLevels(const GreyHistogram& histogram) {
  LevelSums sums;
  for (std::size_t level = 0; level < histogram.size(); ++level) {
    const std::uint64_t count = histogram[level];
    sums.levels += level * count;
    sums.squared_levels += level * level * count;
    sums.squared_counts += count * count;
  }
  return sums;
}

}  // namespace floorloc
