// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/index/extrapolation.h"

#include <algorithm>
#include <cmath>

namespace floorloc {
namespace {

double Along(double IndexTrial::*value, const IndexTrial& a, const IndexTrial& b, double area_m2) {
  const double slope = std::log(b.*value / a.*value) / std::log(b.area_m2 / a.area_m2);
  return b.*value * std::pow(area_m2 / b.area_m2, std::isfinite(slope) ? std::max(slope, 0.0) : 1.0);
}

}  // namespace

IndexTrial Extrapolate(const std::vector<IndexTrial>& trials, double area_m2) {
  const IndexTrial& last = trials.back();
  const IndexTrial& before = trials.size() > 1 ? trials[trials.size() - 2] : last;
  IndexTrial trial{.method = last.method, .area_m2 = area_m2, .extrapolated = true};
  trial.build_s = Along(&IndexTrial::build_s, before, last, area_m2);
  trial.search_ms = Along(&IndexTrial::search_ms, before, last, area_m2);
  trial.bytes_per_keypoint = last.bytes_per_keypoint;
  return trial;
}

}  // namespace floorloc
