// SPDX-License-Identifier: Apache-2.0
#include "core/localization/self_similarity.h"

#include <algorithm>
#include <random>
#include <vector>

namespace floorloc {
namespace {

constexpr int kSample = 400;
constexpr int kNeighbours = 8;
// A twin is elsewhere, not the same point in another descriptor.
constexpr double kElsewhereM = 0.05;
// Bits of 256 by which good views of one point differ at most.
constexpr double kTwinShare = 18.0 / 256.0;

}  // namespace

bool RepeatsItself(const MapKeypoints& map, const DescriptorIndex& index, std::uint32_t seed) {
  if (map.size() < 2 || map.descriptors.depth() != CV_8U) {
    return false;
  }
  std::mt19937 random(seed);
  std::vector<std::size_t> sampled;
  cv::Mat descriptors;
  for (int i = 0; i < kSample; ++i) {
    sampled.push_back(random() % map.size());
    descriptors.push_back(map.descriptors.row(static_cast<int>(sampled.back())));
  }
  const auto max_distance = static_cast<float>(kTwinShare * 8.0 * map.descriptors.cols);
  const auto neighbours = index.Search(descriptors, {.count = kNeighbours, .max_distance = max_distance});
  int twins = 0;
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    const Eigen::Vector2d here = map.keypoints[sampled[i]].Position();
    twins += std::any_of(neighbours[i].begin(), neighbours[i].end(), [&](const Neighbour& n) {
      return (map.keypoints[static_cast<std::size_t>(n.index)].Position() - here).norm() > kElsewhereM;
    });
  }
  return 2 * twins > kSample;
}

}  // namespace floorloc
