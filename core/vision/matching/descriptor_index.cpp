// SPDX-License-Identifier: Apache-2.0
#include "core/vision/matching/descriptor_index.h"

#include <limits>
#include <stdexcept>

#include "core/geometry/option_check.h"
#include "core/vision/matching/brute_force_index.h"
#include "core/vision/matching/flann_index.h"
#include "core/vision/matching/hash_index.h"

namespace floorloc {

const char* ToString(MatcherType type) {
  switch (type) {
    case MatcherType::kAuto:
      return "auto";
    case MatcherType::kBruteForce:
      return "brute_force";
    case MatcherType::kFlann:
      return "flann";
    case MatcherType::kHash:
      return "hash";
  }
  return "unknown";
}

MatcherType ParseMatcherType(const std::string& name) {
  for (const MatcherType type :
       {MatcherType::kAuto, MatcherType::kBruteForce, MatcherType::kFlann, MatcherType::kHash}) {
    if (name == ToString(type)) {
      return type;
    }
  }
  throw std::invalid_argument("unknown matcher '" + name + "'; known are: auto, brute_force, flann, hash");
}

void IndexOptions::Check() const {
  RequireOption(trees >= 1 && trees <= 64, "trees must be 1 to 64");
  RequireOption(checks >= 1 && checks <= 1000000, "checks must be 1 to 1000000");
  RequireOption(probes >= 1 && probes <= kMaxProbes, "probes must be 1 to 4096");
}

std::unique_ptr<DescriptorIndex> CreateDescriptorIndex(const cv::Mat& descriptors, const IndexOptions& options) {
  options.Check();
  // Below this size an exact search is faster than any index.
  constexpr int kSmall = 2000;
  const bool binary = descriptors.depth() == CV_8U;
  if (options.type == MatcherType::kHash && !binary) {
    throw std::invalid_argument("matcher 'hash' takes binary descriptors only; use auto, flann or brute_force");
  }
  if (options.type == MatcherType::kBruteForce || descriptors.rows < kSmall) {
    return CreateBruteForceIndex(descriptors);
  }
  if (options.type == MatcherType::kFlann || !binary) {
    return CreateFlannIndex(descriptors, options);
  }
  return CreateHashIndex(descriptors, options);
}

std::vector<Match> FindNearest(const DescriptorIndex& index, const cv::Mat& descriptors, int probes) {
  std::vector<Match> matches;
  int query = 0;
  for (const std::vector<Neighbour>& found : index.Search(descriptors, {.count = 2, .probes = probes})) {
    if (!found.empty()) {
      const float second = found.size() > 1 ? found[1].distance : std::numeric_limits<float>::infinity();
      matches.push_back({query, found[0].index, found[0].distance, second});
    }
    ++query;
  }
  return matches;
}

std::vector<Match> FindAllNear(const DescriptorIndex& index, const cv::Mat& descriptors,
                               const NeighbourSearch& search) {
  std::vector<Match> matches;
  int query = 0;
  for (const std::vector<Neighbour>& found : index.Search(descriptors, search)) {
    for (const Neighbour& n : found) {
      matches.push_back({query, n.index, n.distance, std::numeric_limits<float>::infinity()});
    }
    ++query;
  }
  return matches;
}

std::vector<Match> FilterByRatio(const std::vector<Match>& matches, float max_ratio) {
  std::vector<Match> kept;
  for (const Match& match : matches) {
    if (match.distance <= max_ratio * match.second_distance) {
      kept.push_back(match);
    }
  }
  return kept;
}

}  // namespace floorloc
