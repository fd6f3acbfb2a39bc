// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/surface/sharpness.h"

#include <cmath>
#include <cstddef>

namespace floorloc {
namespace {

double MinusLogLikelihood(const std::vector<Eigen::RowVectorXf>& sums, std::span<const int> labels, double sharpness) {
  double total = 0.0;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const Eigen::RowVectorXd powers = sharpness * (sums[i].cast<double>().array() - sums[i].maxCoeff());
    total += std::log(powers.array().exp().sum()) - powers(labels[i]);
  }
  return total;
}

}  // namespace

float FitSharpness(const std::vector<Eigen::RowVectorXf>& sums, std::span<const int> labels) {
  // Convex in the sharpness, hence with one minimum: golden section on its logarithm.
  constexpr double kGolden = 0.6180339887498949;
  constexpr int kSteps = 40;
  double low = std::log(1e-3);
  double high = std::log(1e3);
  for (int i = 0; i < kSteps; ++i) {
    const double a = high - kGolden * (high - low);
    const double b = low + kGolden * (high - low);
    if (MinusLogLikelihood(sums, labels, std::exp(a)) <= MinusLogLikelihood(sums, labels, std::exp(b))) {
      high = b;
    } else {
      low = a;
    }
  }
  return static_cast<float>(std::exp(0.5 * (low + high)));
}

}  // namespace floorloc
