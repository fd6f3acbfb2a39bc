// SPDX-License-Identifier: Apache-2.0
#include "core/localization/pose_decision.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace floorloc {
namespace {

// A pose with more expected false alarms than this is no rival: chance always offers some.
constexpr double kMinSignificance = -1.0;

// How well a keypoint fits a pose: 0 where the pose has nothing alike for it.
double Score(float distance, float max_distance) { return std::max(0.0, static_cast<double>(max_distance - distance)); }

// Lead of the first pose in standard deviations, from two witnesses. Were the poses equally right, the differences of
// the scores, keypoint by keypoint, would be as often negative as positive (paired z test); and so would the votes of
// distinctive matches, each of which went to one pose only (sign test).
double LeadSigma(const VerifiedPose& first, const VerifiedPose& second, float max_distance) {
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < first.distance.size(); ++i) {
    const double lead = Score(first.distance[i], max_distance) - Score(second.distance[i], max_distance);
    sum += lead;
    squares += lead * lead;
  }
  const double by_score = squares > 0.0 ? sum / std::sqrt(squares) : 0.0;
  const double by_votes = (first.votes - second.votes) / std::sqrt(std::max(1, first.votes + second.votes));
  return (by_score + by_votes) / std::numbers::sqrt2;  // Stouffer's sum
}

double RivalProbability(const VerifiedPose& first, const VerifiedPose& second, float max_distance) {
  return 0.5 * std::erfc(LeadSigma(first, second, max_distance) / std::numbers::sqrt2);
}

std::size_t FindBest(const std::vector<VerifiedPose>& poses, float max_distance) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if (LeadSigma(poses[i], poses[best], max_distance) > 0.0) {
      best = i;
    }
  }
  return best;
}

PoseHypothesis ToHypothesis(const VerifiedPose& pose, double weight) {
  return {pose.candidate.target_from_source, static_cast<int>(pose.candidate.inliers.size()), weight};
}

}  // namespace

PoseDecision DecidePose(const std::vector<VerifiedPose>& poses, float max_distance,
                        const RegistrationOptions& options) {
  PoseDecision decision;
  if (poses.empty()) {
    return decision;
  }
  const std::size_t best = FindBest(poses, max_distance);
  if (static_cast<int>(poses[best].candidate.inliers.size()) < options.min_inliers) {
    return decision;
  }
  decision.best = static_cast<int>(best);
  std::vector<double> rival(poses.size(), 0.0);
  double p_rival = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (i != best && poses[i].candidate.log_false_alarms < kMinSignificance) {
      rival[i] = RivalProbability(poses[best], poses[i], max_distance);
      p_rival += rival[i];
    }
  }
  const double p_chance = std::min(1.0, std::pow(10.0, poses[best].candidate.log_false_alarms));
  decision.p_wrong = std::min(1.0, p_chance + p_rival / (1.0 + p_rival));
  const double sum = 1.0 + p_rival;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (rival[i] / sum > options.max_p_wrong) {
      decision.alternatives.push_back(ToHypothesis(poses[i], rival[i] / sum));
    }
  }
  if (p_chance > options.max_p_wrong) {
    decision.status = RegistrationStatus::kNotSignificant;
  } else if (decision.p_wrong > options.max_p_wrong) {
    decision.status = RegistrationStatus::kAmbiguous;
    decision.alternatives.insert(decision.alternatives.begin(), ToHypothesis(poses[best], 1.0 / sum));
  } else {
    decision.status = RegistrationStatus::kRegistered;
  }
  return decision;
}

}  // namespace floorloc
