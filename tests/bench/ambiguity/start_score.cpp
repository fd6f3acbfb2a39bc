// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/ambiguity/start_score.h"

#include <algorithm>
#include <cmath>

#include "core/evaluation/fix_score.h"
#include "tests/bench/ambiguity/frame_evidence.h"

namespace floorloc {
namespace {

double MedianOrZero(const std::vector<double>& values) { return values.empty() ? 0.0 : Percentile(values, 0.5); }

}  // namespace

std::optional<double> QuantileOfSome(std::vector<double> values, std::size_t all, double share) {
  const auto rank = static_cast<std::size_t>(std::max(1.0, std::ceil(share * static_cast<double>(all))));
  if (rank > values.size()) {
    return std::nullopt;
  }
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(rank - 1);
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

StartScore ScoreStarts(const std::vector<StartOutcome>& outcomes) {
  StartScore score;
  std::vector<double> metres;
  std::vector<double> frames;
  for (const StartOutcome& outcome : outcomes) {
    ++score.starts;
    score.answers += outcome.answers;
    score.wrong_answers += outcome.wrong;
    if (outcome.first) {
      ++score.localized;
      score.first_wrong += outcome.first->wrong ? 1 : 0;
      score.first_unfounded += outcome.first->unfounded ? 1 : 0;
      metres.push_back(outcome.first->metres);
      frames.push_back(outcome.first->frames);
    }
  }
  score.median_m = QuantileOfSome(metres, outcomes.size(), 0.5);
  score.ninety_m = QuantileOfSome(metres, outcomes.size(), 0.9);
  score.median_frames = QuantileOfSome(frames, outcomes.size(), 0.5);
  score.ninety_frames = QuantileOfSome(frames, outcomes.size(), 0.9);
  return score;
}

FrameScore ScoreFrames(const std::vector<RecordedDrive>& drives) {
  FrameScore score;
  std::vector<double> bits;
  std::vector<double> near_ms;
  std::vector<double> alone_ms;
  std::vector<double> tracker_ms;
  for (const RecordedDrive& drive : drives) {
    for (std::size_t i = 0; i < drive.frames.size(); ++i) {
      const RecordedFrame& frame = drive.frames[i];
      const TrackedFrame& tracked = drive.tracked[i];
      ++score.frames;
      const auto of_frame =
          frame.global.lattice ? BitsOfFrame(*frame.global.lattice, frame.map_from_base) : std::nullopt;
      if (of_frame) {
        bits.push_back(*of_frame);
      }
      if (frame.global.status == LocalizationStatus::kLocalized) {
        ++(IsWrong(frame.global.map_from_base, frame.map_from_base) ? score.wrong_alone : score.right_alone);
      }
      score.expected += tracked.expected ? 1 : 0;
      score.localized += tracked.expected && tracked.localized ? 1 : 0;
      score.wrong += tracked.expected && tracked.wrong ? 1 : 0;
      (tracked.expected ? near_ms : alone_ms).push_back(tracked.localize_ms);
      tracker_ms.push_back(tracked.tracker_ms);
    }
  }
  score.compared = static_cast<int>(bits.size());
  score.mean_bits = bits.empty() ? 0.0 : Mean(bits);
  score.median_bits = MedianOrZero(bits);
  score.median_ms = MedianOrZero(near_ms);
  score.median_alone_ms = MedianOrZero(alone_ms);
  score.median_tracker_ms = MedianOrZero(tracker_ms);
  return score;
}

}  // namespace floorloc
