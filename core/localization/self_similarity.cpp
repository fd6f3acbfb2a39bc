// SPDX-License-Identifier: Apache-2.0
#include "core/localization/self_similarity.h"

#include <algorithm>
#include <random>
#include <vector>

#include "core/geometry/option_check.h"

namespace floorloc {

void SelfSimilarityOptions::Check() const {
  RequireOption(sample >= 1 && sample <= 1000000, "sample must be 1 to 1000000");
  RequireOption(neighbours >= 1 && neighbours <= 1000, "neighbours must be 1 to 1000");
  RequireOption(min_distance_m > 0, "min_distance_m must be positive");
  RequireOption(max_bit_share >= 0 && max_bit_share < 1, "max_bit_share must be 0 to 1");
  RequireOption(min_duplicate_share > 0 && min_duplicate_share < 1, "min_duplicate_share must be between 0 and 1");
}

bool IsSelfSimilar(const MapKeypoints& map, const DescriptorIndex& index, const SelfSimilarityOptions& options,
                   std::uint32_t seed) {
  if (map.size() < 2 || map.descriptors.depth() != CV_8U) {
    return false;
  }
  std::mt19937 random(seed);
  std::vector<std::size_t> sampled;
  cv::Mat descriptors;
  for (int i = 0; i < options.sample; ++i) {
    sampled.push_back(random() % map.size());
    descriptors.push_back(map.descriptors.row(static_cast<int>(sampled.back())));
  }
  const auto max_distance = static_cast<float>(options.max_bit_share * 8.0 * map.descriptors.cols);
  const auto neighbours = index.Search(descriptors, {.count = options.neighbours, .max_distance = max_distance});
  int duplicates = 0;
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    const Eigen::Vector2d here = map.keypoints[sampled[i]].Position();
    duplicates += std::any_of(neighbours[i].begin(), neighbours[i].end(), [&](const Neighbour& n) {
      return (map.keypoints[static_cast<std::size_t>(n.index)].Position() - here).norm() > options.min_distance_m;
    });
  }
  return duplicates > options.min_duplicate_share * options.sample;
}

}  // namespace floorloc
