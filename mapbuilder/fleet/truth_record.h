// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "core/geometry/pose2.h"

namespace floorloc {

/// Where a vehicle truly was in the last seconds.
class TruthRecord {
 public:
  explicit TruthRecord(double kept_s = 20.0) : kept_s_(kept_s) {}

  /// Times must increase.
  void Add(double time_s, const Pose2& map_from_base);
  /// Interpolated, and extrapolated by some hundredths of a second; nothing outside of what is kept. Within a jump, the
  /// pose before it.
  std::optional<Pose2> At(double time_s) const;

 private:
  struct Entry {
    double time_s;
    Pose2 map_from_base;
  };

  double kept_s_;
  std::deque<Entry> entries_;
};

}  // namespace floorloc
