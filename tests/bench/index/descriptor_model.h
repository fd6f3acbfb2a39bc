// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <random>

namespace floorloc {

enum class BitDependence {
  kCorrelated,   ///< bits as skewed and as correlated as in the real descriptors
  kIndependent,  ///< as skewed, but independent of each other
};

/// Makes up descriptors of 256 bits that have the statistics of real ones: a Gaussian copula, that is, bits are signs
/// of normal values whose correlations give those of the real bits.
class DescriptorModel {
 public:
  DescriptorModel(const cv::Mat& descriptors, BitDependence dependence, std::uint32_t seed);

  /// Overwrites the rows [first, end) of `descriptors`.
  void Fill(int first, int end, cv::Mat* descriptors);

 private:
  Eigen::MatrixXf loadings_;   // bits x factors
  Eigen::VectorXf noise_;      // what the factors leave of each bit's value, standard deviation
  Eigen::VectorXf threshold_;  // of each bit's value
  Eigen::VectorXf normals_;    // drawn once, used from random places on
  std::mt19937_64 random_;
};

}  // namespace floorloc
