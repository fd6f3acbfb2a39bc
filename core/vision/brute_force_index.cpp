// SPDX-License-Identifier: Apache-2.0
#include "core/vision/brute_force_index.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/vision/hamming.h"

namespace floorloc {
namespace {

using RowMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Keeps the count smallest distances, nearest first; of equal ones the smaller index.
class NearestList {
 public:
  explicit NearestList(int count) : count_(static_cast<std::size_t>(count)) {}

  void Consider(int index, float distance) {
    if (list_.size() == count_ && distance >= list_.back().distance) {
      return;
    }
    if (list_.size() == count_) {
      list_.pop_back();
    }
    const auto place = std::upper_bound(list_.begin(), list_.end(), distance,
                                        [](float d, const Neighbour& n) { return d < n.distance; });
    list_.insert(place, {index, distance});
  }
  std::vector<Neighbour>& list() { return list_; }

 private:
  std::size_t count_;
  std::vector<Neighbour> list_;
};

class BruteForceHamming final : public DescriptorIndex {
 public:
  explicit BruteForceHamming(const cv::Mat& descriptors) : train_(descriptors) {}

  std::vector<std::vector<Neighbour>> FindNeighbours(const cv::Mat& descriptors, int count) const override {
    const PackedDescriptors queries(descriptors);
    std::vector<std::vector<Neighbour>> neighbours;
    for (int q = 0; q < queries.rows(); ++q) {
      neighbours.push_back(count <= 2 ? TwoNearestOf(queries.row(q), count) : NearestOf(queries.row(q), count));
    }
    return neighbours;
  }
  int size() const override { return train_.rows(); }

 private:
  std::vector<Neighbour> TwoNearestOf(const std::uint64_t* query, int count) const {
    const TwoNearest best = FindTwoNearest(train_, query);
    std::vector<Neighbour> list;
    if (best.index >= 0) {
      list.push_back({best.index, static_cast<float>(best.distance)});
    }
    if (best.second_index >= 0 && count == 2) {
      list.push_back({best.second_index, static_cast<float>(best.second_distance)});
    }
    return list;
  }
  std::vector<Neighbour> NearestOf(const std::uint64_t* query, int count) const {
    NearestList nearest(count);
    for (int i = 0; i < train_.rows(); ++i) {
      nearest.Consider(i, static_cast<float>(HammingDistance(train_, i, query)));
    }
    return std::move(nearest.list());
  }

  PackedDescriptors train_;
};

RowMatrix ToMatrix(const cv::Mat& descriptors) {
  RowMatrix matrix(descriptors.rows, descriptors.cols);
  for (int i = 0; i < descriptors.rows; ++i) {
    std::copy_n(descriptors.ptr<float>(i), descriptors.cols, matrix.row(i).data());
  }
  return matrix;
}

class BruteForceEuclidean final : public DescriptorIndex {
 public:
  explicit BruteForceEuclidean(const cv::Mat& descriptors)
      : train_(ToMatrix(descriptors)), train_norm_(train_.rowwise().squaredNorm()) {}

  std::vector<std::vector<Neighbour>> FindNeighbours(const cv::Mat& descriptors, int count) const override {
    const RowMatrix queries = ToMatrix(descriptors);
    std::vector<std::vector<Neighbour>> neighbours;
    // |a - b|^2 = |a|^2 + |b|^2 - 2 a.b, a block of queries at a time: a matrix product is the fastest loop there is.
    constexpr Eigen::Index kBlock = 64;
    for (Eigen::Index first = 0; first < queries.rows(); first += kBlock) {
      const Eigen::Index rows = std::min(kBlock, queries.rows() - first);
      RowMatrix squared = -2.0F * queries.middleRows(first, rows) * train_.transpose();
      squared.rowwise() += train_norm_.transpose();
      for (Eigen::Index i = 0; i < rows; ++i) {
        NearestList nearest(count);
        for (Eigen::Index j = 0; j < squared.cols(); ++j) {
          nearest.Consider(static_cast<int>(j), squared(i, j));
        }
        for (Neighbour& n : nearest.list()) {
          n.distance = std::sqrt(std::max(n.distance + queries.row(first + i).squaredNorm(), 0.0F));
        }
        neighbours.push_back(std::move(nearest.list()));
      }
    }
    return neighbours;
  }
  int size() const override { return static_cast<int>(train_.rows()); }

 private:
  RowMatrix train_;
  Eigen::VectorXf train_norm_;
};

}  // namespace

std::unique_ptr<DescriptorIndex> CreateBruteForceIndex(const cv::Mat& descriptors) {
  if (descriptors.type() == CV_32F) {
    return std::make_unique<BruteForceEuclidean>(descriptors);
  }
  return std::make_unique<BruteForceHamming>(descriptors);
}

}  // namespace floorloc
