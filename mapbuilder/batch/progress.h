// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <iosfwd>
#include <mutex>
#include <string>

namespace floorloc {

/// Output of progress. The default is silent, so that library code can report unconditionally.
struct ProgressOutput {
  std::ostream* stream = nullptr;  ///< nullptr: silent
  bool in_place = false;           ///< redraw one line (terminal) instead of a plain line every 10 %
  /// Least time between plain lines of a stage, but for its last one: a few items would be a line each.
  std::chrono::milliseconds line_interval{5000};

  /// Standard error, in place when it is a terminal.
  static ProgressOutput Stderr();
};

/// Progress of one stage: "label [#####.....] 50 % 100/200, 3 s left". Thread-safe.
class ProgressBar {
 public:
  /// total: the number of steps; 0 when there is nothing to do.
  ProgressBar(std::string label, std::int64_t total, const ProgressOutput& output);
  /// Ends the line of an unfinished bar, so that an error message starts on a new line.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void Advance(std::int64_t steps = 1);

 private:
  using Clock = std::chrono::steady_clock;

  void Draw(Clock::time_point now);
  void PrintLine(Clock::time_point now);
  std::string Figures(Clock::time_point now) const;

  const std::string label_;
  const std::int64_t total_;
  const ProgressOutput output_;
  const Clock::time_point start_;
  std::mutex mutex_;
  std::int64_t done_ = 0;
  std::int64_t shown_tenths_ = 0;
  Clock::time_point drawn_;  ///< last output, at first the start
  bool line_open_ = false;
};

}  // namespace floorloc
