// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace floorloc {

constexpr int kGreyLevels = 256;
using GreyHistogram = std::array<std::uint32_t, kGreyLevels>;

/// 8-bit pixels in rows; stride: bytes from row to row.
struct GreyPixels {
  const std::uint8_t* first;
  std::size_t stride;
  int width;
  int height;
};

GreyHistogram CountGreyLevels(const GreyPixels& pixels);

/// Over all pixels of a histogram. Exact.
struct LevelSums {
  std::uint64_t levels = 0;
  std::uint64_t squared_levels = 0;
  std::uint64_t squared_counts = 0;  ///< of the pixels of each level
};

LevelSums SumLevels(const GreyHistogram& histogram);

}  // namespace floorloc
