// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "tests/bench/ambiguity/start_methods.h"

namespace floorloc {

/// When a method first said that it knows where the vehicle is.
struct FirstAnswer {
  int frames = 0;       ///< seen until then, this one included
  double metres = 0.0;  ///< driven until then
  bool wrong = false;   ///< farther than kWrongM from the truth
  /// On a floor of identical tiles nothing tells this: the motion fits into the hall elsewhere, too (FitsElsewhere).
  bool unfounded = false;
};

/// What a method answered from one start on.
struct StartOutcome {
  std::optional<FirstAnswer> first;  ///< empty: never within the distance that was followed
  int frames = 0;                    ///< that were followed
  int answers = 0;                   ///< of them those at which it claimed a pose
  int wrong = 0;                     ///< of those the wrong ones
};

/// Where a start begins, and how far it is followed.
struct StartPlan {
  std::size_t frame = 0;  ///< the first one that is seen
  double metres = 0.0;
};

/// `count` starts of a drive, evenly spaced, the last of them `follow_m` before its end; fewer where the drive has not
/// so many frames for them.
std::vector<StartPlan> PlanStarts(const RecordedDrive& drive, int count, double follow_m);

/// Plays a drive to a method that knows nothing, from the start's first frame on.
StartOutcome ReplayStart(const RecordedDrive& drive, const Hall& hall, const StartPlan& plan, StartMethod* method);

}  // namespace floorloc
