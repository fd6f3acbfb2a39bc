// SPDX-License-Identifier: Apache-2.0
#include "core/vision/brute_force_index.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/vision/hamming.h"

namespace floorloc {
namespace {

using RowMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

class BruteForceHamming final : public DescriptorIndex {
 public:
  explicit BruteForceHamming(const cv::Mat& descriptors) : train_(descriptors) {}

  std::vector<Match> FindNearest(const cv::Mat& descriptors) const override {
    const PackedDescriptors queries(descriptors);
    std::vector<Match> matches;
    for (int q = 0; q < queries.rows(); ++q) {
      const TwoNearest best = FindTwoNearest(train_, queries.row(q));
      if (best.index >= 0) {
        const float second = train_.rows() > 1 ? static_cast<float>(best.second_distance)
                                               : std::numeric_limits<float>::infinity();
        matches.push_back({q, best.index, static_cast<float>(best.distance), second});
      }
    }
    return matches;
  }
  int size() const override { return train_.rows(); }

 private:
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

  std::vector<Match> FindNearest(const cv::Mat& descriptors) const override {
    const RowMatrix queries = ToMatrix(descriptors);
    std::vector<Match> matches;
    // |a - b|^2 = |a|^2 + |b|^2 - 2 a.b, a block of queries at a time: a matrix product is the fastest loop there is.
    constexpr Eigen::Index kBlock = 64;
    for (Eigen::Index first = 0; first < queries.rows() && train_.rows() > 0; first += kBlock) {
      const Eigen::Index count = std::min(kBlock, queries.rows() - first);
      RowMatrix squared = -2.0F * queries.middleRows(first, count) * train_.transpose();
      squared.rowwise() += train_norm_.transpose();
      for (Eigen::Index i = 0; i < count; ++i) {
        matches.push_back(NearestInRow(static_cast<int>(first + i), squared.row(i), queries.row(first + i).squaredNorm()));
      }
    }
    return matches;
  }
  int size() const override { return static_cast<int>(train_.rows()); }

 private:
  static Match NearestInRow(int query, const Eigen::Ref<const Eigen::RowVectorXf>& squared, float query_norm) {
    float best = std::numeric_limits<float>::infinity();
    float second = best;
    int index = 0;
    for (int i = 0; i < squared.size(); ++i) {
      if (squared[i] < best) {
        second = best;
        best = squared[i];
        index = i;
      } else if (squared[i] < second) {
        second = squared[i];
      }
    }
    const auto distance = [&](float s) { return std::sqrt(std::max(s + query_norm, 0.0F)); };
    return {query, index, distance(best), distance(second)};
  }

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
