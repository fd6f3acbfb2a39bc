// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/odometry_step_text.h"

#include <cmath>
#include <map>
#include <numbers>

#include "mapbuilder/screening/format_number.h"

namespace floorloc {
namespace {

// Turns below this are not worth naming.
constexpr double kNamedTurnRad = 5.0 * std::numbers::pi / 180.0;

std::string Sentence(const FalseOdometryStep& step, const FrameSet& set) {
  const BuildFrame& first = set.frames[static_cast<std::size_t>(step.first)];
  const BuildFrame& second = set.frames[static_cast<std::size_t>(step.second)];
  const double turn = std::abs(step.by_odometry.yaw());
  std::string text = (set.surveys[static_cast<std::size_t>(first.survey)].survey.folder / "odometry.tum").string() +
                     ": step of " + FormatNumber("%.2f m", step.by_odometry.translation().norm());
  if (turn > kNamedTurnRad) {
    text += FormatNumber(" and %.0f degrees", ToDegrees(turn));
  }
  text += " between " + first.info.filename + " and " + second.info.filename;
  if (step.by_images) {
    return text + FormatNumber(" contradicts the images (%.2f m); left out", step.by_images->translation().norm());
  }
  return text + FormatNumber(" is %.0f times as fast as the others; left out", step.times_usual);
}

std::string StandingSentence(const std::vector<FalseOdometryStep>& span, const FrameSet& set) {
  const BuildFrame& first = set.frames[static_cast<std::size_t>(span.front().first)];
  const BuildFrame& last = set.frames[static_cast<std::size_t>(span.back().second)];
  double moved_m = 0.0;
  for (const FalseOdometryStep& step : span) {
    moved_m += step.by_images ? step.by_images->translation().norm() : 0.0;
  }
  char seconds[32], metres[48] = "";
  std::snprintf(seconds, sizeof(seconds), "%.1f s", ToSeconds(last.info.stamp_ns - first.info.stamp_ns));
  if (moved_m > 0.0) {
    std::snprintf(metres, sizeof(metres), " by %.2f m", moved_m);
  }
  return (set.surveys[static_cast<std::size_t>(first.survey)].survey.folder / "odometry.tum").string() +
         ": stands still for " + seconds + " from " + first.info.filename + " to " + last.info.filename +
         " while the images move on" + metres +
         "; left out: check the encoder's cable, and whether the driver restarted";
}

// Steps at a standstill that follow each other are one span.
std::size_t EndOfSpan(const std::vector<FalseOdometryStep>& steps, std::size_t begin) {
  std::size_t end = begin + 1;
  while (end < steps.size() && steps[begin].standing && steps[end].standing &&
         steps[end - 1].second == steps[end].first) {
    ++end;
  }
  return end;
}

}  // namespace

std::vector<std::string> NameSteps(const std::vector<FalseOdometryStep>& steps, const FrameSet& set, int named) {
  std::map<int, int> count;  // by survey
  std::vector<std::string> sentences;
  for (std::size_t i = 0; i < steps.size();) {
    const std::size_t end = EndOfSpan(steps, i);
    if (++count[set.frames[static_cast<std::size_t>(steps[i].first)].survey] <= named) {
      sentences.push_back(steps[i].standing ? StandingSentence({&steps[i], &steps[i] + (end - i)}, set)
                                            : Sentence(steps[i], set));
    }
    i = end;
  }
  for (const auto& [survey, all] : count) {
    if (all > named) {
      sentences.push_back((set.surveys[static_cast<std::size_t>(survey)].survey.folder / "odometry.tum").string() +
                          ": " + std::to_string(all - named) + " more steps like these are left out");
    }
  }
  return sentences;
}

}  // namespace floorloc
