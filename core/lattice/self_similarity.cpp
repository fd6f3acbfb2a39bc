// SPDX-License-Identifier: Apache-2.0
#include "core/lattice/self_similarity.h"

#include <algorithm>
#include <random>
#include <utility>

#include "core/geometry/option_check.h"

namespace floorloc {

void SelfSimilarityOptions::Check() const {
  RequireOption(sample >= 1 && sample <= 1000000, "sample must be 1 to 1000000");
  RequireOption(neighbours >= 1 && neighbours <= 1000, "neighbours must be 1 to 1000");
  RequireOption(min_distance_m > 0, "min_distance_m must be positive");
  RequireOption(max_bit_share >= 0 && max_bit_share < 1, "max_bit_share must be 0 to 1");
  RequireOption(min_duplicate_share > 0 && min_duplicate_share < 1, "min_duplicate_share must be between 0 and 1");
}

std::vector<SimilarKeypoints> FindSimilarKeypoints(const MapKeypoints& map, const DescriptorIndex& index,
                                                   const SimilaritySearch& search) {
  std::mt19937 random(search.seed);
  std::vector<SimilarKeypoints> found;
  cv::Mat descriptors;
  for (int i = 0; i < search.sample; ++i) {
    found.push_back({random() % map.size(), {}});
    descriptors.push_back(map.descriptors.row(static_cast<int>(found.back().keypoint)));
  }
  const auto max_distance = static_cast<float>(search.max_bit_share * 8.0 * map.descriptors.cols);
  std::vector<std::vector<Neighbour>> neighbours =
      index.Search(descriptors, {.count = search.count, .max_distance = max_distance});
  for (std::size_t i = 0; i < found.size(); ++i) {
    found[i].similar = std::move(neighbours[i]);
  }
  return found;
}

bool IsSelfSimilar(const MapKeypoints& map, const DescriptorIndex& index, const SelfSimilarityOptions& options,
                   std::uint32_t seed) {
  if (map.size() < 2 || map.descriptors.depth() != CV_8U) {
    return false;
  }
  const std::vector<SimilarKeypoints> sampled =
      FindSimilarKeypoints(map, index, {options.sample, options.neighbours, options.max_bit_share, seed});
  const auto duplicates = std::count_if(sampled.begin(), sampled.end(), [&](const SimilarKeypoints& one) {
    const Eigen::Vector2d here = map.keypoints[one.keypoint].Position();
    return std::any_of(one.similar.begin(), one.similar.end(), [&](const Neighbour& n) {
      return (map.keypoints[static_cast<std::size_t>(n.index)].Position() - here).norm() > options.min_distance_m;
    });
  });
  return static_cast<double>(duplicates) > options.min_duplicate_share * options.sample;
}

}  // namespace floorloc
