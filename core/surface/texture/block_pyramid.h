// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace floorloc {

/// Side of a block of floor, pixels of the rectified image.
constexpr int kFloorBlockPx = 48;
/// Levels of a block's pyramid: means over squares of 2, 4, 8 and 16 pixels.
constexpr int kPyramidLevels = 4;

/// What is measured in a block: exact sums, the same on every processor.
struct BlockPyramid {
  double mean = 0.0;                              ///< grey level
  double variance = 0.0;                          ///< of the means over 2 x 2 pixels
  double energy = 0.0;                            ///< sum of their squared probabilities, in steps of half a grey level
  double clipped = 0.0;                           ///< share of these means that are white
  std::array<double, kPyramidLevels> contrast{};  ///< mean squared difference of neighbouring means, by level
};

/// first: the block's top left pixel; stride: bytes from row to row.
BlockPyramid MeasureBlockPyramid(const std::uint8_t* first, std::size_t stride);

}  // namespace floorloc
