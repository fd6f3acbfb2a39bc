// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "core/io/stamp_range.h"

namespace floorloc {

/// The stamps of a sender's latest messages, in the order in which they came.
class StampSeries {
 public:
  /// max_size: older ones are forgotten.
  explicit StampSeries(std::size_t max_size) : max_size_(max_size) {}

  void Add(std::int64_t stamp_ns);
  bool empty() const { return stamps_.empty(); }
  std::size_t size() const { return stamps_.size(); }
  std::int64_t newest_ns() const { return stamps_.back(); }  ///< that came last; there must be one
  /// Earliest and latest; there must be one.
  StampRange Range() const;

  /// From each message to the next one, where it is later; s.
  std::vector<double> StepsS() const;
  /// How many were not later than the one before.
  std::size_t CountBackward() const;
  /// The largest step back; 0: none, s.
  double LargestStepBackS() const;

 private:
  std::size_t max_size_;
  std::deque<std::int64_t> stamps_;
};

}  // namespace floorloc
