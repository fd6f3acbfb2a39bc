// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/retry.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace floorloc::client {
namespace {

using std::chrono::milliseconds;

// replaced: a newer image of the vehicle took the place of this one; sending it again would push that one out.
// no_maps: no call succeeds before somebody brings one.
bool IsFinal(const std::string& reason) { return reason == "replaced" || reason == "no_maps"; }

milliseconds Times(milliseconds wait, double factor) {
  return milliseconds(std::llround(static_cast<double>(wait.count()) * factor));
}

}  // namespace

void RetryOptions::Check() const {
  const auto require = [](bool right, const char* what) {
    if (!right) {
      throw std::invalid_argument(what);
    }
  };
  require(attempts >= 1, "attempts must be at least 1");
  require(first_wait.count() >= 0, "first_wait must not be negative");
  require(max_wait.count() >= 0, "max_wait must not be negative");
  require(jitter >= 0.0, "jitter must not be negative");
}

std::optional<milliseconds> WaitBeforeRetry(const RetryOptions& options, const Failure& failure, int attempt,
                                            std::mt19937_64& random) {
  const bool overloaded = (failure.status == 429 || failure.status == 503) && !IsFinal(failure.reason);
  if (attempt >= options.attempts || !(overloaded || failure.reason == kUnreachable)) {
    return std::nullopt;
  }
  std::uniform_real_distribution<double> share(0.0, 1.0);
  if (!failure.retry_after) {
    const milliseconds longest = std::min(options.max_wait, Times(options.first_wait, std::exp2(attempt - 1)));
    return Times(longest, share(random));
  }
  if (*failure.retry_after > options.max_wait) {
    return std::nullopt;
  }
  return Times(*failure.retry_after, 1.0 + options.jitter * share(random));
}

std::optional<milliseconds> ParseRetryAfter(const std::string& text) {
  constexpr int kLongestS = 1'000'000;
  int seconds = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
  if (error != std::errc() || end != text.data() + text.size() || seconds < 0) {
    return std::nullopt;
  }
  return milliseconds(1000LL * std::min(seconds, kLongestS));
}

}  // namespace floorloc::client
