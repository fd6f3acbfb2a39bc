// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>

namespace floorloc {

/// Nanoseconds of a decimal number of seconds, every digit kept. Empty when it is none or beyond 4e9 s, so that stamps
/// and their differences fit into 64 bits.
std::optional<std::int64_t> ParseStampNs(const std::string& text);
/// The same of a number: what its shortest decimal text means, so that 0.1 s are 100 ms.
std::optional<std::int64_t> ToStampNs(double seconds);

/// Stamps of the last messages of a vehicle, in order of time. Bounded.
class MessageStamps {
 public:
  /// window_ns: how far behind the newest one they are kept.
  explicit MessageStamps(std::int64_t window_ns) : window_ns_(window_ns) {}

  void Add(std::int64_t stamp_ns);
  void Clear() { stamps_.clear(); }
  bool Contains(std::int64_t stamp_ns) const { return stamps_.contains(stamp_ns); }
  std::optional<std::int64_t> Newest() const;
  /// The last one before a time.
  std::optional<std::int64_t> Before(std::int64_t stamp_ns) const;
  /// True for times older than the history.
  bool IsTooOld(std::int64_t stamp_ns) const;

 private:
  static constexpr std::size_t kMaxSize = 4096;

  std::int64_t window_ns_;
  std::set<std::int64_t> stamps_;
};

}  // namespace floorloc
