// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <random>

namespace floorloc {

enum class BitDependence {
  kCorrelated,   ///< means and correlations of the bits as in the real descriptors
  kIndependent,  ///< the same means, but independent bits
};

/// Generates 256-bit descriptors with the statistics of real ones by a Gaussian copula: bits are thresholded normal
/// values whose correlations reproduce those of the real bits.
class DescriptorModel {
 public:
  DescriptorModel(const cv::Mat& descriptors, BitDependence dependence, std::uint32_t seed);

  /// Overwrites the rows [first, end) of `descriptors`.
  void Fill(int first, int end, cv::Mat* descriptors);

 private:
  Eigen::MatrixXf loadings_;   // bits x factors
  Eigen::VectorXf noise_;      // standard deviation of each bit's value that the factors do not explain
  Eigen::VectorXf threshold_;  // on each bit's value
  Eigen::VectorXf normals_;    // drawn once, reused from random offsets
  std::mt19937_64 random_;
};

}  // namespace floorloc
