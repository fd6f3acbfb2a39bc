// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "clients/cpp/call_error.h"

namespace floorloc::client {

/// The end of a call's time, all its attempts and waits included.
class Deadline {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Deadline(std::chrono::milliseconds time) : time_(time), end_(Clock::now() + time) {}

  /// What is left. Throws CallError when nothing is.
  std::chrono::microseconds Left() const {
    const auto left = std::chrono::duration_cast<std::chrono::microseconds>(end_ - Clock::now());
    if (left.count() <= 0) {
      throw Exceeded();
    }
    return left;
  }
  bool Allows(std::chrono::milliseconds wait) const { return Clock::now() + wait < end_; }
  CallError Exceeded() const {
    return CallError({0, kDeadlineExceeded, "There was no answer within " + std::to_string(time_.count()) + " ms.",
                      std::nullopt, ""});
  }

 private:
  std::chrono::milliseconds time_;
  Clock::time_point end_;
};

}  // namespace floorloc::client
