// SPDX-License-Identifier: Apache-2.0
#include "server/http/histogram.h"

#include <algorithm>
#include <array>
#include <iterator>

namespace floorloc {

void Histogram::Observe(double value) {
  const auto bound = std::lower_bound(bounds_.begin(), bounds_.end(), value);
  if (bound != bounds_.end()) {
    ++counts_[static_cast<std::size_t>(std::distance(bounds_.begin(), bound))];
  }
  ++total_;
  sum_ += value;
}

std::span<const double> SecondsBounds() {
  static constexpr std::array kBounds = {0.0002, 0.0005, 0.001, 0.002, 0.004, 0.008, 0.015, 0.025, 0.035, 0.05,
                                         0.065,  0.08,   0.1,   0.15,  0.25,  0.5,   1.0,   2.5,   10.0};
  return kBounds;
}

std::span<const double> InlierBounds() {
  static constexpr std::array kBounds = {10.0, 20.0, 40.0, 60.0, 80.0, 120.0, 160.0, 240.0, 320.0, 480.0, 640.0, 960.0};
  return kBounds;
}

std::span<const double> RiskBounds() {
  static constexpr std::array kBounds = {1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1};
  return kBounds;
}

}  // namespace floorloc
