// SPDX-License-Identifier: Apache-2.0
#include "core/surface/texture/block_pyramid.h"

#include <algorithm>

#include "core/vision/image/multiversion.h"

namespace floorloc {
namespace {

// Sums over squares, of a level whose side is kSide squares.
template <int kSide>
using Level = std::array<std::int32_t, static_cast<std::size_t>(kSide) * kSide>;

template <int kSide>
FLOORLOC_INLINE void Halve(const Level<2 * kSide>& fine, Level<kSide>* coarse) {
  for (int v = 0; v < kSide; ++v) {
    const std::int32_t* upper = fine.data() + 4 * v * kSide;
    const std::int32_t* lower = upper + 2 * kSide;
    for (int u = 0; u < kSide; ++u) {
      const int at = v * kSide + u;
      (*coarse)[static_cast<std::size_t>(at)] = upper[2 * u] + upper[2 * u + 1] + lower[2 * u] + lower[2 * u + 1];
    }
  }
}

FLOORLOC_INLINE std::uint32_t Squared(std::int32_t difference) {
  return static_cast<std::uint32_t>(difference) * static_cast<std::uint32_t>(difference);
}

// Mean squared difference of horizontal and vertical neighbours, in grey levels squared. pixels: of a square. The
// squares of a row add up to less than 2^32: in whole numbers every processor finds the same.
template <int kSide>
FLOORLOC_INLINE double Contrast(const Level<kSide>& level, double pixels) {
  std::uint64_t sum = 0;
  for (int v = 0; v < kSide; ++v) {
    const std::int32_t* row = level.data() + v * kSide;
    std::uint32_t of_row = 0;
    for (int u = 0; u + 1 < kSide; ++u) {
      of_row += Squared(row[u + 1] - row[u]);
    }
    sum += of_row;
  }
  for (int v = 0; v + 1 < kSide; ++v) {
    const std::int32_t* row = level.data() + v * kSide;
    std::uint32_t of_row = 0;
    for (int u = 0; u < kSide; ++u) {
      of_row += Squared(row[u + kSide] - row[u]);
    }
    sum += of_row;
  }
  constexpr int kNeighbours = 2 * kSide * (kSide - 1);
  return static_cast<double>(sum) / (kNeighbours * pixels * pixels);
}

constexpr int kFinest = kFloorBlockPx / 2;
constexpr std::size_t kWhite = 4 * 255 / 2;  // sums over four pixels, in steps of two

// Mean, variance and energy of the finest level.
FLOORLOC_INLINE void MeasureDistribution(const Level<kFinest>& level, BlockPyramid* block) {
  std::array<std::uint16_t, 512> histogram{};
  std::int64_t sum = 0;
  std::int64_t squares = 0;
  for (const std::int32_t value : level) {
    ++histogram[static_cast<std::size_t>(value) / 2];
    sum += value;
    squares += std::int64_t{value} * value;
  }
  std::int64_t pairs = 0;
  for (const std::uint16_t count : histogram) {
    pairs += std::int64_t{count} * count;
  }
  constexpr double kCount = kFinest * kFinest;
  const double mean = static_cast<double>(sum) / kCount;
  block->mean = mean / 4.0;
  block->variance = std::max(0.0, (static_cast<double>(squares) / kCount - mean * mean) / 16.0);
  block->energy = static_cast<double>(pairs) / (kCount * kCount);
  block->clipped = histogram[kWhite] / kCount;
}

}  // namespace

FLOORLOC_WIDE_VECTORS
BlockPyramid MeasureBlockPyramid(const std::uint8_t* first, std::size_t stride) {
  Level<kFinest> two;
  for (int v = 0; v < kFinest; ++v) {
    const std::uint8_t* upper = first + 2 * static_cast<std::size_t>(v) * stride;
    const std::uint8_t* lower = upper + stride;
    for (int u = 0; u < kFinest; ++u) {
      const int at = v * kFinest + u;
      two[static_cast<std::size_t>(at)] = upper[2 * u] + upper[2 * u + 1] + lower[2 * u] + lower[2 * u + 1];
    }
  }
  Level<kFinest / 2> four;
  Level<kFinest / 4> eight;
  Level<kFinest / 8> sixteen;
  Halve<kFinest / 2>(two, &four);
  Halve<kFinest / 4>(four, &eight);
  Halve<kFinest / 8>(eight, &sixteen);
  for (std::int32_t& sum : sixteen) {
    sum /= 16;  // their squares would not fit
  }
  BlockPyramid block;
  MeasureDistribution(two, &block);
  block.contrast = {Contrast<kFinest>(two, 4.0), Contrast<kFinest / 2>(four, 16.0), Contrast<kFinest / 4>(eight, 64.0),
                    Contrast<kFinest / 8>(sixteen, 16.0)};
  return block;
}

}  // namespace floorloc
