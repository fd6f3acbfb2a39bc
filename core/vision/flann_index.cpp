// SPDX-License-Identifier: Apache-2.0
#include "core/vision/flann_index.h"

#include <cmath>
#include <flann/flann.hpp>
#include <limits>
#include <mutex>

namespace floorloc {
namespace {

// FLANN draws its random trees from one process-wide generator: seeded builds must not overlap.
std::mutex& BuildMutex() {
  static std::mutex mutex;
  return mutex;
}

template <typename Distance>
class FlannIndex final : public DescriptorIndex {
 public:
  using Element = typename Distance::ElementType;

  FlannIndex(const cv::Mat& descriptors, const flann::IndexParams& params, const IndexOptions& options)
      : data_(descriptors.clone()),
        index_(flann::Matrix<Element>(data_.ptr<Element>(), static_cast<std::size_t>(data_.rows),
                                      static_cast<std::size_t>(data_.cols)),
               params),
        search_(options.checks) {
    search_.cores = 1;
    const std::lock_guard lock(BuildMutex());
    flann::seed_random(options.seed);
    index_.buildIndex();
  }

  std::vector<Match> FindNearest(const cv::Mat& descriptors) const override {
    const auto rows = static_cast<std::size_t>(descriptors.rows);
    const cv::Mat queries = descriptors.isContinuous() ? descriptors : descriptors.clone();
    constexpr std::size_t kNeighbours = 2;
    std::vector<std::size_t> index_data(rows * kNeighbours, kNone);
    std::vector<DistanceType> distance_data(rows * kNeighbours, DistanceType{});
    flann::Matrix<std::size_t> indices(index_data.data(), rows, kNeighbours);
    flann::Matrix<DistanceType> distances(distance_data.data(), rows, kNeighbours);
    index_.knnSearch(flann::Matrix<Element>(const_cast<Element*>(queries.ptr<Element>()), rows,
                                            static_cast<std::size_t>(queries.cols)),
                     indices, distances, kNeighbours, search_);
    std::vector<Match> matches;
    for (std::size_t i = 0; i < rows; ++i) {
      if (index_data[2 * i] < static_cast<std::size_t>(data_.rows)) {
        const bool has_second = index_data[2 * i + 1] < static_cast<std::size_t>(data_.rows);
        matches.push_back({static_cast<int>(i), static_cast<int>(index_data[2 * i]), ToMetric(distance_data[2 * i]),
                           has_second ? ToMetric(distance_data[2 * i + 1]) : std::numeric_limits<float>::infinity()});
      }
    }
    return matches;
  }
  int size() const override { return data_.rows; }

 private:
  using DistanceType = typename Distance::ResultType;
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  // FLANN's L2 is squared.
  static float ToMetric(DistanceType d) {
    return std::is_same_v<Element, float> ? std::sqrt(static_cast<float>(d)) : static_cast<float>(d);
  }

  cv::Mat data_;  // FLANN refers to it
  flann::Index<Distance> index_;
  flann::SearchParams search_;
};

}  // namespace

std::unique_ptr<DescriptorIndex> CreateFlannIndex(const cv::Mat& descriptors, const IndexOptions& options) {
  if (descriptors.type() == CV_32F) {
    return std::make_unique<FlannIndex<flann::L2<float>>>(descriptors, flann::KDTreeIndexParams(options.trees), options);
  }
  constexpr int kBranching = 32;
  constexpr int kLeafSize = 100;
  return std::make_unique<FlannIndex<flann::Hamming<unsigned char>>>(
      descriptors,
      flann::HierarchicalClusteringIndexParams(kBranching, flann::FLANN_CENTERS_RANDOM, options.trees, kLeafSize),
      options);
}

}  // namespace floorloc
