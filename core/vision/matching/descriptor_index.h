// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "core/vision/features/features.h"

namespace floorloc {

/// An indexed descriptor found for a query.
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
  kAuto,        ///< hashing for binary descriptors, FLANN for float ones
  kBruteForce,  ///< exact
  kFlann,       ///< randomised kd-trees (float), hierarchical clusterings (binary)
  kHash,        ///< hashing on learned projections, binary descriptors only
};

const char* ToString(MatcherType type);
MatcherType ParseMatcherType(const std::string& name);

/// Upper limit of IndexOptions::probes.
constexpr int kMaxProbes = 4096;

struct IndexOptions {
  MatcherType type = MatcherType::kAuto;
  int trees = 4;     ///< FLANN: randomised kd-trees, or hierarchical clusterings for binary descriptors
  int checks = 64;   ///< FLANN: leaves checked per query
  int probes = 512;  ///< hashing: buckets probed per query, at most kMaxProbes
  std::uint32_t seed = 1;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Parameters of a search.
struct NeighbourSearch {
  int count = 2;                                                ///< number of nearest neighbours
  float max_distance = std::numeric_limits<float>::infinity();  ///< farther neighbours are left out
  int probes = 0;  ///< hashing: buckets probed per query; 0: as in IndexOptions
};

/// Nearest neighbours among a fixed set of descriptors. Owns its data; binary descriptors may share memory with the
/// matrix passed in, which must not be modified afterwards. Searches are const and thread-safe.
class DescriptorIndex {
 public:
  virtual ~DescriptorIndex() = default;
  DescriptorIndex() = default;
  DescriptorIndex(const DescriptorIndex&) = delete;
  DescriptorIndex& operator=(const DescriptorIndex&) = delete;

  /// Neighbours of every row, nearest first, at most search.count. Throws std::invalid_argument when the rows differ
  /// from the indexed ones in type or length.
  virtual std::vector<std::vector<Neighbour>> Search(const cv::Mat& descriptors,
                                                     const NeighbourSearch& search) const = 0;
  /// The count nearest neighbours of every row.
  std::vector<std::vector<Neighbour>> FindNeighbours(const cv::Mat& descriptors, int count) const {
    return Search(descriptors, {.count = count});
  }
  virtual int size() const = 0;
};

std::unique_ptr<DescriptorIndex> CreateDescriptorIndex(const cv::Mat& descriptors, const IndexOptions& options);

/// The two nearest neighbours of every row as one Match; rows without a neighbour are left out. probes: as in
/// NeighbourSearch.
std::vector<Match> FindNearest(const DescriptorIndex& index, const cv::Mat& descriptors, int probes = 0);

/// Every neighbour of every row as a separate Match, for voting; second_distance is infinity.
std::vector<Match> FindAllNear(const DescriptorIndex& index, const cv::Mat& descriptors, const NeighbourSearch& search);

/// Lowe's ratio test: keeps matches whose nearest neighbour is clearly nearer than the second one.
std::vector<Match> FilterByRatio(const std::vector<Match>& matches, float max_ratio);

}  // namespace floorloc
