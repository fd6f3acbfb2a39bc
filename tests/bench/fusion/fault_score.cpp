// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/fusion/fault_score.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/evaluation/alignment.h"
#include "core/evaluation/consistency.h"
#include "core/fusion/filter_state.h"
#include "tests/bench/fusion/sensor_fault.h"

namespace floorloc {
namespace {

bool IsFrame(const FusionMessage& message) {
  return std::holds_alternative<PoseFix>(message.content) ||
         std::holds_alternative<LocalizationFailure>(message.content);
}

// A fix that is held is held at all times.
std::optional<FusedPose> Answer(const PoseFuser& fuser, const FusionVariant& variant, std::int64_t stamp_ns) {
  return variant.method == FusionMethod::kEkf ? fuser.EstimateAt(stamp_ns) : fuser.Estimate();
}

// True when the error of an answer that claims to know is more than its covariance explains.
bool IsWrong(const FrameAnswer& answer) {
  const FusedPose& pose = *answer.estimate;
  const double error_m = answer.truth.Between(pose.map_from_base).translation().norm();
  return error_m > kClaimSigmas * LargestSigma(pose.covariance.topLeftCorner<2, 2>());
}

}  // namespace

void FaultScore::Add(const FaultScore& other) {
  frames += other.frames;
  good += other.good;
  tracking += other.tracking;
  lost += other.lost;
  longest_wrong_run = std::max(longest_wrong_run, other.longest_wrong_run);
  nees.insert(nees.end(), other.nees.begin(), other.nees.end());
  between.insert(between.end(), other.between.begin(), other.between.end());
}

void ScoreAnswers(const std::vector<FrameAnswer>& answers, FaultScore* score) {
  int run = 0;
  for (const FrameAnswer& answer : answers) {
    score->frames += 1;
    if (!answer.estimate || answer.estimate->state == TrackingState::kLost) {
      score->lost += 1;
      run = 0;
      continue;
    }
    const FusedPose& pose = *answer.estimate;
    const double error_m = answer.truth.Between(pose.map_from_base).translation().norm();
    const bool localized = pose.state == TrackingState::kLocalized;
    score->good += localized && error_m <= kGoodM ? 1 : 0;
    score->tracking += localized ? 0 : 1;
    score->nees.push_back(Nees(answer.truth, pose.map_from_base, pose.covariance));
    run = IsWrong(answer) ? run + 1 : 0;
    score->longest_wrong_run = std::max(score->longest_wrong_run, run);
  }
}

FaultScore ReplayFault(const FusionRecording& recording, const std::vector<FusionMessage>& messages,
                       const FusionVariant& variant) {
  const std::unique_ptr<PoseFuser> fuser = MakePoseFuser(variant.method, variant.options);
  const std::int64_t judged_from_ns =
      recording.truth.front().stamp_ns + std::llround(1e9 * (kFaultOnsetS + kFaultSettleS));
  FaultScore score;
  std::vector<FrameAnswer> answers;
  std::size_t row = 0;
  for (const FusionMessage& message : messages) {
    for (; row < recording.truth.size() && recording.truth[row].stamp_ns < message.arrival_ns; ++row) {
      const StampedPose3& truth = recording.truth[row];
      const auto pose = Answer(*fuser, variant, truth.stamp_ns);
      if (truth.stamp_ns >= judged_from_ns && pose) {
        score.between.push_back(truth.ToPose2().Between(pose->map_from_base).translation().norm());
      }
    }
    DeliverMessage(message, variant, fuser.get());
    const auto truth = InterpolatePose(recording.truth, message.arrival_ns);
    if (IsFrame(message) && message.arrival_ns >= judged_from_ns && truth) {
      answers.push_back({message.arrival_ns, Answer(*fuser, variant, message.arrival_ns), *truth});
    }
  }
  ScoreAnswers(answers, &score);
  return score;
}

}  // namespace floorloc
