// SPDX-License-Identifier: Apache-2.0
#include "core/vision/matching/flann_index.h"

#include <algorithm>
#include <cmath>
#include <opencv2/flann.hpp>
#include <type_traits>

#include "core/vision/features/descriptor_layout.h"

namespace floorloc {
namespace {

// OpenCV's port of FLANN draws its random numbers from this thread's generator, so that a seed fixes the trees. FLANN
// 1.9 itself shuffles by std::random_device and gives another index with every build.
class SeededGenerator {
 public:
  explicit SeededGenerator(std::uint32_t seed) : saved_(cv::theRNG()) { cvflann::seed_random(seed); }
  ~SeededGenerator() { cv::theRNG() = saved_; }
  SeededGenerator(const SeededGenerator&) = delete;
  SeededGenerator& operator=(const SeededGenerator&) = delete;

 private:
  cv::RNG saved_;
};

// Index: cvflann index type for this distance.
template <typename Distance, typename Index>
class FlannIndex final : public DescriptorIndex {
 public:
  using Element = typename Distance::ElementType;

  /// checks: descriptors compared per query.
  FlannIndex(const cv::Mat& descriptors, const cvflann::IndexParams& params, int checks, std::uint32_t seed)
      : data_(descriptors.clone()), index_(ToMatrix(data_), params), search_(checks, 0.0F, true, kExploreAllTrees) {
    const SeededGenerator seeded(seed);
    index_.buildIndex();
  }

  std::vector<std::vector<Neighbour>> Search(const cv::Mat& descriptors, const NeighbourSearch& search) const override {
    CheckComparable(descriptors, LayoutOf(data_));
    std::vector<std::vector<Neighbour>> neighbours(static_cast<std::size_t>(descriptors.rows));
    const int k = std::min(search.count, size());  // OpenCV throws when it finds fewer than requested
    if (k == 0) {
      return neighbours;
    }
    std::vector<int> indices(static_cast<std::size_t>(k));
    std::vector<DistanceType> distances(indices.size());
    for (int i = 0; i < descriptors.rows; ++i) {
      cvflann::KNNUniqueResultSet<DistanceType> nearest(static_cast<unsigned>(k));
      index_.findNeighbors(nearest, descriptors.ptr<Element>(i), search_);
      nearest.copy(indices.data(), distances.data(), k);
      for (std::size_t n = 0; n < indices.size(); ++n) {
        if (const float distance = ToMetric(distances[n]); distance <= search.max_distance) {
          neighbours[static_cast<std::size_t>(i)].push_back({indices[n], distance});
        }
      }
    }
    return neighbours;
  }
  int size() const override { return data_.rows; }

 private:
  using DistanceType = typename Distance::ResultType;
  static constexpr bool kExploreAllTrees = true;  // otherwise the first tree may use up all checks

  static cvflann::Matrix<Element> ToMatrix(cv::Mat& m) {
    return {m.ptr<Element>(), static_cast<std::size_t>(m.rows), static_cast<std::size_t>(m.cols)};
  }

  // FLANN's L2 is squared.
  static float ToMetric(DistanceType d) {
    return std::is_same_v<Element, float> ? std::sqrt(static_cast<float>(d)) : static_cast<float>(d);
  }

  cv::Mat data_;         // must outlive the index, which refers to it
  mutable Index index_;  // its search keeps no state but is not const
  cvflann::SearchParams search_;
};

using FloatDistance = cvflann::L2<float>;
using BinaryDistance = cvflann::Hamming<unsigned char>;
using FloatIndex = FlannIndex<FloatDistance, cvflann::KDTreeIndex<FloatDistance>>;
using BinaryIndex = FlannIndex<BinaryDistance, cvflann::HierarchicalClusteringIndex<BinaryDistance>>;

}  // namespace

std::unique_ptr<DescriptorIndex> CreateFlannIndex(const cv::Mat& descriptors, const IndexOptions& options) {
  if (descriptors.type() == CV_32F) {
    return std::make_unique<FloatIndex>(descriptors, cvflann::KDTreeIndexParams(options.trees), options.checks,
                                        options.seed);
  }
  constexpr int kBranching = 32;
  constexpr int kLeafSize = 20;  // descriptors; a kd-tree's leaf holds one
  const cvflann::HierarchicalClusteringIndexParams clusterings(kBranching, cvflann::FLANN_CENTERS_RANDOM, options.trees,
                                                               kLeafSize);
  return std::make_unique<BinaryIndex>(descriptors, clusterings, kLeafSize * options.checks, options.seed);
}

}  // namespace floorloc
