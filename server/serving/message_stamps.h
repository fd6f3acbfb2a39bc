// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>

namespace floorloc {

/// Parses a decimal number of seconds into nanoseconds without loss of digits. Empty when it is not a number or beyond
/// +-4e9 s, so that stamps and their differences fit into 64 bits.
std::optional<std::int64_t> ParseStampNs(const std::string& text);
/// The same for a number, by its shortest decimal representation, so that 0.1 s is exactly 100 ms.
std::optional<std::int64_t> ToStampNs(double seconds);

/// Stamps of a vehicle's latest messages, sorted; at most kMaxSize.
class MessageStamps {
 public:
  /// window_ns: stamps that are this much older than the newest one are dropped.
  explicit MessageStamps(std::int64_t window_ns) : window_ns_(window_ns) {}

  void Add(std::int64_t stamp_ns);
  void Clear() { stamps_.clear(); }
  bool Contains(std::int64_t stamp_ns) const { return stamps_.contains(stamp_ns); }
  std::optional<std::int64_t> Newest() const;
  /// The latest stamp before the given one.
  std::optional<std::int64_t> Before(std::int64_t stamp_ns) const;
  /// True for stamps before the window.
  bool IsTooOld(std::int64_t stamp_ns) const;

 private:
  static constexpr std::size_t kMaxSize = 4096;

  std::int64_t window_ns_;
  std::set<std::int64_t> stamps_;
};

}  // namespace floorloc
