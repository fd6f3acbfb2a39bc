// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/ambiguity/cold_start.h"

#include <algorithm>

namespace floorloc {

std::vector<StartPlan> PlanStarts(const RecordedDrive& drive, int count, double follow_m) {
  const double last_m = drive.frames.empty() ? -1.0 : drive.frames.back().metres - follow_m;
  const auto end = std::find_if(drive.frames.begin(), drive.frames.end(),
                                [last_m](const RecordedFrame& frame) { return frame.metres > last_m; });
  const auto candidates = static_cast<std::size_t>(end - drive.frames.begin());
  const std::size_t starts = std::min(candidates, static_cast<std::size_t>(count));
  std::vector<StartPlan> plans;
  for (std::size_t i = 0; i < starts; ++i) {
    plans.push_back({i * candidates / starts, follow_m});
  }
  return plans;
}

StartOutcome ReplayStart(const RecordedDrive& drive, const Hall& hall, const StartPlan& plan, StartMethod* method) {
  const RectM view = BenchCamera().floor.roi;
  const double from_m = drive.frames.at(plan.frame).metres;
  std::size_t moved = drive.frames.at(plan.frame).motions_before;
  std::vector<Pose2> truth;
  StartOutcome outcome;
  for (std::size_t i = plan.frame; i < drive.frames.size() && drive.frames[i].metres <= from_m + plan.metres; ++i) {
    const RecordedFrame& frame = drive.frames[i];
    for (; moved < frame.motions_before; ++moved) {
      method->Move(drive.motions[moved]);
    }
    truth.push_back(frame.truth_from_base);
    ++outcome.frames;
    const std::optional<Pose2> answer = method->See(frame);
    if (!answer) {
      continue;
    }
    const bool wrong = IsWrong(*answer, frame.map_from_base);
    ++outcome.answers;
    outcome.wrong += wrong ? 1 : 0;
    if (!outcome.first) {
      outcome.first = {outcome.frames, frame.metres - from_m, wrong, FitsElsewhere(truth, view, hall)};
    }
  }
  return outcome;
}

}  // namespace floorloc
