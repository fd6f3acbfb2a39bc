// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <functional>

#include "core/fusion/filter_options.h"
#include "core/fusion/measurements.h"

namespace floorloc {

/// Remembers the fixes that contradicted a vehicle's pose since the last one that agreed, and detects that the vehicle
/// was moved (the kidnapped robot problem).
class KidnapDetector {
 public:
  using MotionBetween = std::function<MotionEstimate(std::int64_t from_ns, std::int64_t to_ns)>;

  explicit KidnapDetector(const KidnapOptions& options) : options_(options) {}

  /// A fix that was not accepted. Returns how many contradicting fixes agree with it, itself included.
  int AddContradiction(const PoseFix& fix, const MotionBetween& motion_between);
  void Clear();
  /// True when fixes contradicted the pose since the last accepted one.
  bool HasContradictions() const { return !contradictions_.empty(); }
  /// True when the last contradicting fix agrees with an earlier one.
  bool HasConsistentContradictions() const { return agreeing_ > 1; }

 private:
  bool Agree(const PoseFix& earlier, const PoseFix& later, const MotionBetween& motion_between) const;

  KidnapOptions options_;
  std::deque<PoseFix> contradictions_;
  int agreeing_ = 0;  // contradicting fixes that agree with the last one, itself included
};

}  // namespace floorloc
