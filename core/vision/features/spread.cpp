// SPDX-License-Identifier: Apache-2.0
#include "core/vision/features/spread.h"

#include <algorithm>
#include <bit>
#include <cstdint>

namespace floorloc {
namespace {

// Ascending keys: the strongest keypoint first, of equal ones the first.
std::vector<std::uint64_t> SortedByStrength(const std::vector<cv::KeyPoint>& keypoints) {
  std::vector<std::uint64_t> keys;
  keys.reserve(keypoints.size());
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    // The bits of floats are ordered like the floats: those of positive ones upwards, of negative ones downwards.
    const auto bits = std::bit_cast<std::uint32_t>(keypoints[i].response + 0.0F);
    const std::uint32_t descending = (bits >> 31U) != 0 ? bits : ~(bits | 0x80000000U);
    keys.push_back(static_cast<std::uint64_t>(descending) << 32U | i);
  }
  std::sort(keys.begin(), keys.end());
  return keys;
}

}  // namespace

std::vector<int> SpreadEvenly(const std::vector<cv::KeyPoint>& keypoints, int cell_px, int max_count) {
  int columns = 1;
  int rows = 1;
  for (const cv::KeyPoint& k : keypoints) {
    columns = std::max(columns, static_cast<int>(k.pt.x) / cell_px + 1);
    rows = std::max(rows, static_cast<int>(k.pt.y) / cell_px + 1);
  }
  // Rank of a keypoint: how many stronger ones share its cell.
  std::vector<int> taken(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0);
  std::vector<std::vector<int>> by_rank;
  for (const std::uint64_t key : SortedByStrength(keypoints)) {
    const auto index = static_cast<std::uint32_t>(key);
    const cv::Point2f& p = keypoints[index].pt;
    const int cell = static_cast<int>(p.y) / cell_px * columns + static_cast<int>(p.x) / cell_px;
    const auto rank = static_cast<std::size_t>(taken[static_cast<std::size_t>(cell)]++);
    if (rank == by_rank.size()) {
      by_rank.emplace_back();
    }
    by_rank[rank].push_back(static_cast<int>(index));
  }
  std::vector<int> picked;
  for (const std::vector<int>& indices : by_rank) {
    const std::size_t room = static_cast<std::size_t>(max_count) - picked.size();
    picked.insert(picked.end(), indices.begin(),
                  indices.begin() + static_cast<std::ptrdiff_t>(std::min(room, indices.size())));
  }
  return picked;
}

}  // namespace floorloc
