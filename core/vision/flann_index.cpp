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

  std::vector<std::vector<Neighbour>> FindNeighbours(const cv::Mat& descriptors, int count) const override {
    const auto rows = static_cast<std::size_t>(descriptors.rows);
    const auto k = static_cast<std::size_t>(count);
    const cv::Mat queries = descriptors.isContinuous() ? descriptors : descriptors.clone();
    std::vector<std::size_t> index_data(rows * k, kNone);
    std::vector<DistanceType> distance_data(rows * k, DistanceType{});
    flann::Matrix<std::size_t> indices(index_data.data(), rows, k);
    flann::Matrix<DistanceType> distances(distance_data.data(), rows, k);
    index_.knnSearch(flann::Matrix<Element>(const_cast<Element*>(queries.ptr<Element>()), rows,
                                            static_cast<std::size_t>(queries.cols)),
                     indices, distances, k, search_);
    std::vector<std::vector<Neighbour>> neighbours(rows);
    for (std::size_t i = 0; i < rows * k; ++i) {
      if (index_data[i] < static_cast<std::size_t>(data_.rows)) {
        neighbours[i / k].push_back({static_cast<int>(index_data[i]), ToMetric(distance_data[i])});
      }
    }
    return neighbours;
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
