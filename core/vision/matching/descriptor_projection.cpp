// SPDX-License-Identifier: Apache-2.0
#include "core/vision/matching/descriptor_projection.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstring>

namespace floorloc {
namespace {

constexpr int kSampleRows = 4096;
constexpr std::size_t kHalfByteValues = 16;

float SignOfBit(const std::uint64_t* words, int bit) { return (words[bit / 64] >> (bit % 64) & 1) != 0 ? 1.0F : -1.0F; }

// One column per sampled descriptor, mean zero.
Eigen::MatrixXf CenteredSigns(const PackedDescriptors& descriptors) {
  const std::vector<int> rows = SampleRows(descriptors.rows(), kSampleRows);
  Eigen::MatrixXf signs(64 * descriptors.words_per_row(), static_cast<Eigen::Index>(rows.size()));
  for (Eigen::Index column = 0; column < signs.cols(); ++column) {
    const std::uint64_t* words = descriptors.row(rows[static_cast<std::size_t>(column)]);
    for (int bit = 0; bit < signs.rows(); ++bit) {
      signs(bit, column) = SignOfBit(words, bit);
    }
  }
  return signs.colwise() - signs.rowwise().mean().eval();
}

}  // namespace

std::vector<int> SampleRows(int rows, int max_rows) {
  std::vector<int> sample(static_cast<std::size_t>(std::min(rows, max_rows)));
  for (std::size_t i = 0; i < sample.size(); ++i) {
    sample[i] = static_cast<int>(i * static_cast<std::size_t>(rows) / sample.size());
  }
  return sample;
}

DescriptorProjection::DescriptorProjection(const PackedDescriptors& descriptors)
    : bytes_(8 * descriptors.words_per_row()) {
  sums_.assign(static_cast<std::size_t>(2 * bytes_) * kHalfByteValues, Values{});
  if (descriptors.rows() == 0) {
    return;
  }
  const Eigen::MatrixXf signs = CenteredSigns(descriptors);
  const Eigen::MatrixXf covariance = signs * signs.transpose() / static_cast<float>(signs.cols());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXf> solver(covariance);
  const Eigen::Index bits = signs.rows();
  const Eigen::MatrixXf directions = solver.eigenvectors().rightCols(std::min<Eigen::Index>(kDimensions, bits));
  // The largest sum fits 16 bits, including the rounding of its terms.
  const float scale = 30000.0F / directions.cwiseAbs().colwise().sum().maxCoeff();
  for (Eigen::Index d = 0; d < directions.cols(); ++d) {
    const Eigen::Index column = directions.cols() - 1 - d;  // the solver sorts by increasing eigenvalue
    const auto dimension = static_cast<std::size_t>(d);
    variances_[dimension] = std::max(0.0F, solver.eigenvalues()(bits - 1 - d));
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      float sum = 0.0F;
      for (std::size_t b = 0; b < 4; ++b) {
        const float weight = directions(static_cast<Eigen::Index>(4 * (i / kHalfByteValues) + b), column);
        sum += (i >> b & 1) != 0 ? weight : -weight;
      }
      sums_[i][dimension] = static_cast<std::int16_t>(std::lround(scale * sum));
    }
  }
}

DescriptorProjection::Values DescriptorProjection::Project(const std::uint64_t* words) const {
  // Maps to as few vector registers as the processor allows.
  using Lanes [[gnu::vector_size(sizeof(Values))]] = std::int16_t;
  Lanes total{};
  const Values* sums = sums_.data();
  for (int word = 0; word < bytes_ / 8; ++word) {
    for (int shift = 0; shift < 64; shift += 4, sums += kHalfByteValues) {
      Lanes part;
      std::memcpy(&part, sums[words[word] >> shift & 15].data(), sizeof(part));
      total += part;
    }
  }
  Values values;
  std::memcpy(values.data(), &total, sizeof(values));
  return values;
}

}  // namespace floorloc
