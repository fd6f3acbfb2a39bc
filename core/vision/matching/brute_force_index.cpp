// SPDX-License-Identifier: Apache-2.0
#include "core/vision/matching/brute_force_index.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/vision/features/descriptor_layout.h"
#include "core/vision/matching/hamming.h"
#include "core/vision/matching/nearest_list.h"

namespace floorloc {
namespace {

using RowMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

class BruteForceHamming final : public DescriptorIndex {
 public:
  explicit BruteForceHamming(const cv::Mat& descriptors) : layout_(LayoutOf(descriptors)), train_(descriptors) {}

  std::vector<std::vector<Neighbour>> Search(const cv::Mat& descriptors, const NeighbourSearch& search) const override {
    CheckComparable(descriptors, layout_);
    const PackedDescriptors queries(descriptors);
    std::vector<std::vector<Neighbour>> neighbours;
    std::vector<int> all(static_cast<std::size_t>(train_.rows()));
    std::iota(all.begin(), all.end(), 0);
    for (int q = 0; q < queries.rows(); ++q) {
      neighbours.push_back(search.count <= 2 ? ToNeighbours(FindTwoNearest(train_, queries.row(q)), search)
                                             : NearestHamming(train_, queries.row(q), all, search));
    }
    return neighbours;
  }
  int size() const override { return train_.rows(); }

 private:
  DescriptorLayout layout_;
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
      : layout_(LayoutOf(descriptors)), train_(ToMatrix(descriptors)), train_norm_(train_.rowwise().squaredNorm()) {}

  std::vector<std::vector<Neighbour>> Search(const cv::Mat& descriptors, const NeighbourSearch& search) const override {
    CheckComparable(descriptors, layout_);
    const RowMatrix queries = ToMatrix(descriptors);
    std::vector<std::vector<Neighbour>> neighbours;
    // |a - b|^2 = |a|^2 + |b|^2 - 2 a.b, a block of queries at a time, as a matrix product is fastest.
    constexpr Eigen::Index kBlock = 64;
    for (Eigen::Index first = 0; first < queries.rows(); first += kBlock) {
      const Eigen::Index rows = std::min(kBlock, queries.rows() - first);
      RowMatrix squared = -2.0F * queries.middleRows(first, rows) * train_.transpose();
      squared.rowwise() += train_norm_.transpose();
      for (Eigen::Index i = 0; i < rows; ++i) {
        NearestList nearest({.count = search.count});
        for (Eigen::Index j = 0; j < squared.cols(); ++j) {
          nearest.Consider(static_cast<int>(j), squared(i, j));
        }
        for (Neighbour& n : nearest.list()) {
          n.distance = std::sqrt(std::max(n.distance + queries.row(first + i).squaredNorm(), 0.0F));
        }
        std::erase_if(nearest.list(), [&](const Neighbour& n) { return n.distance > search.max_distance; });
        neighbours.push_back(std::move(nearest.list()));
      }
    }
    return neighbours;
  }
  int size() const override { return static_cast<int>(train_.rows()); }

 private:
  DescriptorLayout layout_;
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
