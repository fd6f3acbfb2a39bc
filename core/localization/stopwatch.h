// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace floorloc {

/// Measures how long the stages of a result take.
class Stopwatch {
 public:
  /// Milliseconds since construction or the last lap.
  double LapMs() {
    const auto now = std::chrono::steady_clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - start_).count();
    start_ = now;
    return ms;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace floorloc
