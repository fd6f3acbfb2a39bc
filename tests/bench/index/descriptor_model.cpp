// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/index/descriptor_model.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

namespace floorloc {
namespace {

constexpr int kFactors = 48;
constexpr int kPool = 1 << 18;

// Bits as +-1: bits x descriptors.
Eigen::MatrixXf Signs(const cv::Mat& descriptors) {
  constexpr int kMaxRows = 20000;
  const int rows = std::min(descriptors.rows, kMaxRows);
  Eigen::MatrixXf signs(8 * descriptors.cols, rows);
  for (int i = 0; i < rows; ++i) {
    const auto row = static_cast<int>(static_cast<std::int64_t>(i) * descriptors.rows / rows);
    for (int bit = 0; bit < signs.rows(); ++bit) {
      signs(bit, i) = (descriptors.at<std::uint8_t>(row, bit / 8) >> (bit % 8) & 1) != 0 ? 1.0F : -1.0F;
    }
  }
  return signs;
}

// Correlations of the latent normal values from those of their signs: rho = sin(pi / 2 * r), the inverted arcsine law.
Eigen::MatrixXf LatentCorrelations(const Eigen::MatrixXf& signs) {
  const Eigen::MatrixXf centered = signs.colwise() - signs.rowwise().mean().eval();
  const Eigen::MatrixXf covariance = centered * centered.transpose() / static_cast<float>(signs.cols());
  const Eigen::VectorXf scale = covariance.diagonal().cwiseMax(1e-6F).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXf correlation = scale.asDiagonal() * covariance * scale.asDiagonal();
  return (0.5F * std::numbers::pi_v<float> * correlation.array()).sin();
}

}  // namespace

DescriptorModel::DescriptorModel(const cv::Mat& descriptors, BitDependence dependence, std::uint32_t seed)
    : random_(seed) {
  const Eigen::MatrixXf signs = Signs(descriptors);
  const Eigen::Index bits = signs.rows();
  loadings_ = Eigen::MatrixXf::Zero(bits, kFactors);
  if (dependence == BitDependence::kCorrelated) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXf> solver(LatentCorrelations(signs));
    const Eigen::VectorXf spread = solver.eigenvalues().tail(kFactors).cwiseMax(0.0F).cwiseSqrt();
    loadings_ = solver.eigenvectors().rightCols(kFactors) * spread.asDiagonal();
  }
  noise_ = (1.0F - loadings_.rowwise().squaredNorm().array()).cwiseMax(0.01F).sqrt();
  normals_.resize(kPool);
  std::normal_distribution<float> normal;
  std::generate(normals_.begin(), normals_.end(), [&] { return normal(random_); });
  // A bit is set where the normal value exceeds the quantile at the bit's share of zeros.
  std::vector<float> sorted(normals_.begin(), normals_.end());
  std::sort(sorted.begin(), sorted.end());
  threshold_.resize(bits);
  for (Eigen::Index b = 0; b < bits; ++b) {
    const double zeros = 0.5 * (1.0 - signs.row(b).mean());
    threshold_(b) = sorted[static_cast<std::size_t>(std::clamp(zeros, 0.0, 1.0) * (kPool - 1))];
  }
}

void DescriptorModel::Fill(int first, int end, cv::Mat* descriptors) {
  constexpr int kBlock = 512;
  const Eigen::Index bits = loadings_.rows();
  const auto place = [&](Eigen::Index length) {
    return static_cast<Eigen::Index>(random_() % static_cast<std::uint64_t>(kPool - length));
  };
  Eigen::MatrixXf factors(kFactors, kBlock);
  Eigen::MatrixXf values(bits, kBlock);
  for (int start = first; start < end; start += kBlock) {
    for (Eigen::Index i = 0; i < kBlock; ++i) {
      factors.col(i) = normals_.segment(place(kFactors), kFactors);
      values.col(i) = noise_.cwiseProduct(normals_.segment(place(bits), bits)) - threshold_;
    }
    values.noalias() += loadings_ * factors;
    for (int i = 0; i < std::min(kBlock, end - start); ++i) {
      std::uint8_t* row = descriptors->ptr(start + i);
      for (Eigen::Index byte = 0; byte < bits / 8; ++byte) {
        unsigned packed = 0;
        for (Eigen::Index b = 0; b < 8; ++b) {
          packed |= static_cast<unsigned>(values(8 * byte + b, i) > 0.0F) << b;
        }
        row[byte] = static_cast<std::uint8_t>(packed);
      }
    }
  }
}

}  // namespace floorloc
