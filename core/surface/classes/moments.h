// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace floorloc {

/// Sums of vectors of N numbers and of their products.
template <std::size_t N>
class Moments {
 public:
  void Add(const std::array<double, N>& x) {
    ++count_;
    for (std::size_t i = 0; i < N; ++i) {
      sum_[i] += x[i];
      for (std::size_t j = 0; j <= i; ++j) {
        products_[i][j] += x[i] * x[j];
      }
    }
  }

  int count() const { return count_; }

  /// The mean, then the rows of the covariance matrix: N + N^2 numbers. There must be a sample.
  std::vector<float> MeanAndCovariance() const {
    std::vector<float> numbers;
    const double n = count_;
    for (std::size_t i = 0; i < N; ++i) {
      numbers.push_back(static_cast<float>(sum_[i] / n));
    }
    for (std::size_t i = 0; i < N; ++i) {
      for (std::size_t j = 0; j < N; ++j) {
        const double products = i >= j ? products_[i][j] : products_[j][i];
        numbers.push_back(static_cast<float>(products / n - sum_[i] / n * (sum_[j] / n)));
      }
    }
    return numbers;
  }

 private:
  int count_ = 0;
  std::array<double, N> sum_ = {};
  std::array<std::array<double, N>, N> products_ = {};
};

}  // namespace floorloc
