// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace floorloc {

/// From the earliest to the latest stamp of one sender.
struct StampRange {
  std::int64_t first_ns = 0;
  std::int64_t last_ns = 0;

  /// Of a list of things with a stamp_ns, in order of time; it must not be empty.
  template <typename Stamped>
  static StampRange Of(const Stamped& list) {
    return {list.front().stamp_ns, list.back().stamp_ns};
  }
};

/// Two senders whose stamps can't be of one clock.
struct ForeignClocks {
  std::string sentence;         ///< with both ranges, without a full stop
  std::string cure;             ///< what to do, by what the ranges look like: another unit, epoch or time zone
  bool of_other_scale = false;  ///< another unit or epoch: not one clock at two times
};

/// Compares the stamps of images with those of another sender. name: "odometry", "the IMU", as in a sentence.
/// tolerance_s: how far apart ranges of one clock may be. Empty where the ranges overlap.
std::optional<ForeignClocks> CompareClocks(const StampRange& images, const StampRange& other, const std::string& name,
                                           double tolerance_s = 0.0);

/// What to do about a stamp that is no time in seconds, when it looks like milliseconds, microseconds or nanoseconds
/// since 1970; for the end of an error. Else empty.
std::optional<std::string> HintAboutUnit(std::string_view stamp);

}  // namespace floorloc
