// SPDX-License-Identifier: Apache-2.0
#include "core/diagnosis/stamp_series.h"

#include <algorithm>

#include "core/io/trajectory.h"

namespace floorloc {

void StampSeries::Add(std::int64_t stamp_ns) {
  stamps_.push_back(stamp_ns);
  if (stamps_.size() > max_size_) {
    stamps_.pop_front();
  }
}

StampRange StampSeries::Range() const {
  const auto [first, last] = std::minmax_element(stamps_.begin(), stamps_.end());
  return {*first, *last};
}

std::vector<double> StampSeries::StepsS() const {
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < stamps_.size(); ++i) {
    if (stamps_[i] > stamps_[i - 1]) {
      steps_s.push_back(ToSeconds(stamps_[i] - stamps_[i - 1]));
    }
  }
  return steps_s;
}

std::size_t StampSeries::CountBackward() const { return stamps_.empty() ? 0 : stamps_.size() - 1 - StepsS().size(); }

double StampSeries::LargestStepBackS() const {
  double largest_s = 0.0;
  for (std::size_t i = 1; i < stamps_.size(); ++i) {
    largest_s = std::max(largest_s, ToSeconds(stamps_[i - 1] - stamps_[i]));
  }
  return largest_s;
}

}  // namespace floorloc
