// SPDX-License-Identifier: Apache-2.0
#include "core/registration/pose_choice.h"

#include <algorithm>

namespace floorloc {
namespace {

// Odds -> weights. The best one has odds of 1, so the sum is at least 1.
std::vector<PoseHypothesis> Normalize(std::vector<PoseHypothesis> hypotheses) {
  double sum = 0.0;
  for (const PoseHypothesis& hypothesis : hypotheses) {
    sum += hypothesis.weight;
  }
  for (PoseHypothesis& hypothesis : hypotheses) {
    hypothesis.weight /= sum;
  }
  return hypotheses;
}

}  // namespace

PoseDecision ChoosePose(const PoseContest& contest, const RegistrationOptions& options) {
  PoseDecision decision;
  if (contest.hypotheses.empty() || contest.hypotheses[contest.best].inliers < options.min_inliers) {
    return decision;
  }
  decision.best = static_cast<int>(contest.best);
  const std::vector<PoseHypothesis> weighed = Normalize(contest.hypotheses);
  double p_rival = 0.0;
  for (std::size_t i = 0; i < weighed.size(); ++i) {
    if (i != contest.best) {
      p_rival += weighed[i].weight;
      if (weighed[i].weight > options.max_p_wrong) {
        decision.alternatives.push_back(weighed[i]);
      }
    }
  }
  decision.p_wrong =
      std::clamp(contest.p_chance + contest.p_local + contest.p_missed + p_rival, options.min_p_wrong, 1.0);
  if (contest.p_chance > options.max_p_wrong) {
    decision.status = RegistrationStatus::kNotSignificant;
  } else if (contest.p_local > options.max_p_wrong) {
    decision.status = RegistrationStatus::kViewDisagrees;
  } else if (decision.p_wrong > options.max_p_wrong) {
    decision.status = RegistrationStatus::kAmbiguous;
    decision.alternatives.insert(decision.alternatives.begin(), weighed[contest.best]);
  } else {
    decision.status = RegistrationStatus::kRegistered;
  }
  return decision;
}

}  // namespace floorloc
