// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tests/bench/scenes/bench_floor.h"
#include "tests/bench/scenes/frame_plan.h"
#include "tests/bench/scenes/frame_record.h"

namespace floorloc {

/// The image of a planned frame (CV_8UC1). floor: the floor that it shows, in the state of the condition.
cv::Mat RenderFrame(const GrayRenderer& renderer, const GrayFloor& floor, const ConditionCase& condition,
                    const FramePlan& plan);

/// Renders the planned frames of one floor and localizes them. Run is thread-safe and deterministic, except for the
/// measured times.
class FrameRunner {
 public:
  /// Refers to the floors, which must outlive it.
  FrameRunner(const BenchFloor& floor, FramePlanner planner, std::vector<const GrayFloor*> others,
              std::vector<ConditionCase> conditions);

  FrameRecord Run(int frame) const;

 private:
  cv::Mat Render(const FramePlan& plan) const;
  FixRecord Localize(const FramePlan& plan, const PlannedSearch& search, const cv::Mat& raw) const;

  const BenchFloor& floor_;
  FramePlanner planner_;
  std::vector<const GrayFloor*> others_;
  std::vector<ConditionCase> conditions_;
  GrayRenderer renderer_;
  Rectifier rectifier_;
};

/// True when both are equal except for the times: the program gives the same results.
bool SameAnswers(const FrameRecord& a, const FrameRecord& b);

}  // namespace floorloc
