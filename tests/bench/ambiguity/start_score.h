// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "tests/bench/ambiguity/cold_start.h"

namespace floorloc {

/// A method's starts on one floor under one condition.
struct StartScore {
  int starts = 0;
  int localized = 0;        ///< that ever called a pose localized
  int first_wrong = 0;      ///< of these, whose first pose was wrong
  int first_unfounded = 0;  ///< of these, whose first pose nothing on a floor of identical tiles tells
  int answers = 0;          ///< frames at which a pose was claimed, over all starts
  int wrong_answers = 0;    ///< of these, with a wrong pose
  /// Distance and number of frames to the first pose, which half and nine tenths of the starts do not exceed; empty: so
  /// many were not localized within the distance that was followed.
  std::optional<double> median_m, ninety_m;
  std::optional<double> median_frames, ninety_frames;
};

StartScore ScoreStarts(const std::vector<StartOutcome>& outcomes);

/// A value that a share of `all` values does not exceed, where `values` are those that are known and the others are
/// larger than any of them. Empty where it is among the others, or there are none at all.
std::optional<double> QuantileOfSome(std::vector<double> values, std::size_t all, double share);

/// What the frames of some drives tell, and what became of those while a tracker knew where it was.
struct FrameScore {
  int frames = 0;
  int compared = 0;  ///< those that have bits
  double mean_bits = 0.0;
  double median_bits = 0.0;
  int right_alone = 0;  ///< localized without a prior, and right
  int wrong_alone = 0;
  int expected = 0;                ///< frames while the tracker knew where it was
  int localized = 0;               ///< of these
  int wrong = 0;                   ///< of these
  double median_ms = 0.0;          ///< of localizing one of them
  double median_tracker_ms = 0.0;  ///< of telling the tracker
  double median_alone_ms = 0.0;    ///< of localizing a frame while lost
};

FrameScore ScoreFrames(const std::vector<RecordedDrive>& drives);

}  // namespace floorloc
