// SPDX-License-Identifier: Apache-2.0
#include "server/serving/message_stamps.h"

#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <string>

#include "core/io/trajectory.h"

namespace floorloc {
namespace {

constexpr std::int64_t kMaxStampNs = 4'000'000'000'000'000'000;

// Far below a nanosecond: rounded to zero before formatting, which would need a long buffer.
constexpr double kSmallestS = 1e-12;

}  // namespace

std::optional<std::int64_t> ParseStampNs(const std::string& text) {
  const std::optional<std::int64_t> stamp_ns = ParseSeconds(text);
  return stamp_ns && std::abs(*stamp_ns) <= kMaxStampNs ? stamp_ns : std::nullopt;
}

std::optional<std::int64_t> ToStampNs(double seconds) {
  if (std::abs(seconds) < kSmallestS) {
    return 0;
  }
  std::array<char, 64> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), seconds).ptr;
  return ParseStampNs({text.data(), end});
}

void MessageStamps::Add(std::int64_t stamp_ns) {
  stamps_.insert(stamp_ns);
  while (stamps_.size() > 1 && (stamps_.size() > kMaxSize || *stamps_.begin() < *stamps_.rbegin() - window_ns_)) {
    stamps_.erase(stamps_.begin());
  }
}

std::optional<std::int64_t> MessageStamps::Newest() const {
  return stamps_.empty() ? std::nullopt : std::optional(*stamps_.rbegin());
}

std::optional<std::int64_t> MessageStamps::Before(std::int64_t stamp_ns) const {
  const auto at = stamps_.lower_bound(stamp_ns);
  return at == stamps_.begin() ? std::nullopt : std::optional(*std::prev(at));
}

bool MessageStamps::IsTooOld(std::int64_t stamp_ns) const {
  return !stamps_.empty() && stamp_ns < *stamps_.rbegin() - window_ns_;
}

}  // namespace floorloc
