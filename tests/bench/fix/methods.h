// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/localization/localizer.h"
#include "tests/bench/common/baseline.h"
#include "tests/bench/common/bench_frames.h"
#include "tests/bench/common/score.h"

namespace floorloc {

/// Medians over the frames.
struct StageTimes {
  double decode_ms = 0.0;
  double rectify_ms = 0.0;
  double features_ms = 0.0;
  double match_ms = 0.0;
  double register_ms = 0.0;
};

/// Results of a method on a set of frames.
struct MethodRun {
  std::vector<Fix> fixes;  ///< one per frame
  StageTimes stages;       ///< zero for a baseline, which is timed as a whole
};

using Priors = std::vector<std::optional<PosePrior>>;

/// No prior for any of the frames.
Priors NoPriors(std::size_t frames);
/// Priors within 0.1 m and 0.1 rad of the truth. truth_from_map: from AlignMapToTruth.
Priors PerturbedPriors(const std::vector<Pose2>& truth_from_base, const Pose2& truth_from_map);

/// Localizes the frames one after the other.
MethodRun RunLocalizer(const Localizer& localizer, const BenchFrames& frames, const Priors& priors);
MethodRun RunBaseline(const Baseline& baseline, const BenchFrames& frames);

/// Localizes all frames repeatedly for about two seconds in `threads` threads.
double MeasureFixesPerSecond(const Localizer& localizer, const BenchFrames& frames, const Priors& priors, int threads);

}  // namespace floorloc
