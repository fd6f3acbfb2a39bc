// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/batch/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <utility>

namespace floorloc {
namespace {

constexpr int kBarCells = 30;
constexpr auto kRedrawInterval = std::chrono::milliseconds(100);
constexpr const char* kClearToEndOfLine = "\x1b[K";

std::string FormatDuration(double seconds) {
  const auto whole = static_cast<std::int64_t>(std::ceil(seconds));
  if (whole < 60) {
    return std::to_string(whole) + " s";
  }
  if (whole < 3600) {
    return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
  }
  return std::to_string(whole / 3600) + " h " + std::to_string(whole % 3600 / 60) + " min";
}

}  // namespace

ProgressOutput ProgressOutput::Stderr() { return {&std::cerr, isatty(STDERR_FILENO) == 1}; }

ProgressBar::ProgressBar(std::string label, std::int64_t total, const ProgressOutput& output)
    : label_(std::move(label)), total_(total), output_(output), start_(Clock::now()), drawn_(start_) {
  if (output_.stream != nullptr && output_.in_place && total_ > 0) {
    Draw(start_);
  }
}

ProgressBar::~ProgressBar() {
  if (line_open_) {
    *output_.stream << std::endl;
  }
}

void ProgressBar::Advance(std::int64_t steps) {
  const std::scoped_lock lock(mutex_);
  done_ = std::min(done_ + steps, total_);
  if (output_.stream == nullptr || total_ <= 0) {
    return;
  }
  const Clock::time_point now = Clock::now();
  if (output_.in_place) {
    if (done_ == total_ || now - drawn_ >= kRedrawInterval) {
      Draw(now);
    }
  } else if (done_ * 10 / total_ > shown_tenths_ && (done_ == total_ || now - drawn_ >= output_.line_interval)) {
    PrintLine(now);
  }
}

void ProgressBar::Draw(Clock::time_point now) {
  const auto full = static_cast<std::size_t>(kBarCells * done_ / total_);
  *output_.stream << '\r' << label_ << " [" << std::string(full, '#') << std::string(kBarCells - full, '.') << "] "
                  << Figures(now) << kClearToEndOfLine;
  output_.stream->flush();
  drawn_ = now;
  line_open_ = true;
}

void ProgressBar::PrintLine(Clock::time_point now) {
  *output_.stream << label_ << ": " << Figures(now) << std::endl;
  shown_tenths_ = done_ * 10 / total_;
  drawn_ = now;
}

std::string ProgressBar::Figures(Clock::time_point now) const {
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  std::string text =
      std::to_string(100 * done_ / total_) + " % " + std::to_string(done_) + "/" + std::to_string(total_);
  if (done_ == total_) {
    return text + ", " + FormatDuration(elapsed_s);
  }
  if (done_ > 0) {
    text +=
        ", " + FormatDuration(elapsed_s * static_cast<double>(total_ - done_) / static_cast<double>(done_)) + " left";
  }
  return text;
}

}  // namespace floorloc
