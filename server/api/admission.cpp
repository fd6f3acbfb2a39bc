// SPDX-License-Identifier: Apache-2.0
#include "server/api/admission.h"

#include <charconv>
#include <cmath>
#include <string>

namespace floorloc {
namespace {

constexpr int kMaxDeadlineMs = 60'000;

std::optional<ComputePool::Seconds> ReadDeadline(const HttpRequest& request) {
  const std::string text = request.Header("x-deadline-ms");
  if (text.empty()) {
    return std::nullopt;
  }
  int milliseconds = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), milliseconds);
  if (error != std::errc() || end != text.data() + text.size() || milliseconds < 1 || milliseconds > kMaxDeadlineMs) {
    throw Problem(
        400, "invalid_parameter",
        "X-Deadline-Ms is how many milliseconds you wait for the answer: 1 to " + std::to_string(kMaxDeadlineMs) + ".");
  }
  return ComputePool::Seconds(1e-3 * milliseconds);
}

}  // namespace

JobLabel MakeLabel(const HttpRequest& request, std::string client, WorkClass work) {
  return {std::move(client), work, ReadDeadline(request)};
}

void RequireTime(const AppState& state, const JobLabel& label) {
  const double deadline_s = label.deadline ? label.deadline->count() : 1e-3 * state.config.deadline_ms;
  const double expected_s = state.pool.ExpectedTime(label).count();
  if (expected_s > deadline_s) {
    const int retry_s = static_cast<int>(std::ceil(std::max(1.0, expected_s - deadline_s)));
    throw Overload("deadline",
                   "The answer is expected in " + std::to_string(std::lround(1e3 * expected_s)) +
                       " ms, later than the " + std::to_string(std::lround(1e3 * deadline_s)) +
                       " ms that you wait for it; try again in a moment, or raise X-Deadline-Ms.",
                   retry_s);
  }
}

}  // namespace floorloc
