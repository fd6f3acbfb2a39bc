// SPDX-License-Identifier: Apache-2.0
#include "core/vision/features/spread.h"

#include <algorithm>
#include <numeric>
#include <unordered_map>

namespace floorloc {

std::vector<int> SpreadEvenly(const std::vector<cv::KeyPoint>& keypoints, int cell_px, int max_count) {
  std::vector<int> order(keypoints.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return keypoints[static_cast<std::size_t>(a)].response > keypoints[static_cast<std::size_t>(b)].response;
  });
  // rank = how many stronger keypoints share the cell.
  std::unordered_map<long, int> taken;
  std::vector<std::pair<int, int>> rank_and_index;
  rank_and_index.reserve(order.size());
  for (const int i : order) {
    const cv::Point2f p = keypoints[static_cast<std::size_t>(i)].pt;
    const long cell = static_cast<long>(p.y) / cell_px * 65536L + static_cast<long>(p.x) / cell_px;
    rank_and_index.emplace_back(taken[cell]++, i);
  }
  // The stable sort keeps the strongest first within one rank.
  std::stable_sort(rank_and_index.begin(), rank_and_index.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<int> picked;
  for (const auto& [rank, index] : rank_and_index) {
    if (static_cast<int>(picked.size()) == max_count) {
      break;
    }
    picked.push_back(index);
  }
  return picked;
}

}  // namespace floorloc
