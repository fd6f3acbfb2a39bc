// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "core/vision/features.h"

namespace floorloc {

/// An indexed descriptor, seen from a query.
struct Neighbour {
  int index = 0;
  float distance = 0.0F;  ///< bits (binary) or Euclidean (float)
};

/// Query descriptor -> one of the indexed descriptors.
struct Match {
  int query = 0;
  int train = 0;
  float distance = 0.0F;         ///< bits (binary) or Euclidean (float)
  float second_distance = 0.0F;  ///< of the next neighbour; infinity when there is none
};

enum class MatcherType {
  kAuto,        ///< multi-index hashing for binary descriptors, FLANN for float ones
  kBruteForce,  ///< exact
  kFlann,       ///< randomised kd-trees (float), hierarchical clusterings (binary)
  kMih,         ///< multi-index hashing, binary descriptors only
};

const char* ToString(MatcherType type);
MatcherType ParseMatcherType(const std::string& name);

struct IndexOptions {
  MatcherType type = MatcherType::kAuto;
  int trees = 4;    ///< FLANN: randomised kd-trees, or hierarchical clusterings for binary descriptors
  int checks = 64;  ///< FLANN: leaves looked at per query
  std::uint32_t seed = 1;
};

/// Nearest neighbours among a fixed set of descriptors. Owns its data; searches are const and thread-safe.
class DescriptorIndex {
 public:
  virtual ~DescriptorIndex() = default;
  DescriptorIndex() = default;
  DescriptorIndex(const DescriptorIndex&) = delete;
  DescriptorIndex& operator=(const DescriptorIndex&) = delete;

  /// The count nearest neighbours of every row, nearest first; fewer when the index holds fewer.
  virtual std::vector<std::vector<Neighbour>> FindNeighbours(const cv::Mat& descriptors, int count) const = 0;
  virtual int size() const = 0;
};

std::unique_ptr<DescriptorIndex> CreateDescriptorIndex(const cv::Mat& descriptors, const IndexOptions& options);

/// The two nearest neighbours of every row as one Match; rows without a neighbour are left out.
std::vector<Match> FindNearest(const DescriptorIndex& index, const cv::Mat& descriptors);

/// Lowe's ratio test: keeps matches whose nearest neighbour is clearly nearer than the second one.
std::vector<Match> FilterByRatio(const std::vector<Match>& matches, float max_ratio);

}  // namespace floorloc
