// SPDX-License-Identifier: Apache-2.0
#include "core/localization/pose_decision.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <vector>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

// How well a keypoint fits a pose; 0 without a match.
double Score(float distance, float max_distance) { return std::max(0.0, static_cast<double>(max_distance - distance)); }

// Paired z test: under the hypothesis that two poses are equally right the differences of their scores have mean zero.
class PairedTest {
 public:
  void Add(double lead) {
    sum_ += lead;
    squares_ += lead * lead;
  }
  double Sigma() const { return squares_ > 0.0 ? sum_ / std::sqrt(squares_) : 0.0; }

 private:
  double sum_ = 0.0;
  double squares_ = 0.0;
};

// The part of the image by which two poses can be compared.
class CommonFloor {
 public:
  CommonFloor(const VerifiedPose& first, const VerifiedPose& second, const std::vector<int>& cell_of_keypoint)
      : cell_of_keypoint_(cell_of_keypoint) {
    if (first.photo && second.photo) {
      for (std::size_t c = 0; c < first.photo->cell_samples.size(); ++c) {
        cells_.push_back(first.photo->cell_samples[c] > 0 && second.photo->cell_samples[c] > 0);
      }
    }
  }
  bool HasCell(int cell) const { return cells_.empty() || (cell >= 0 && cells_[static_cast<std::size_t>(cell)]); }
  bool HasKeypoint(std::size_t keypoint) const { return cells_.empty() || HasCell(cell_of_keypoint_[keypoint]); }

 private:
  const std::vector<int>& cell_of_keypoint_;
  std::vector<bool> cells_;  // per cell of the frame; empty: the whole frame
};

double LeadByKeypoints(const VerifiedPose& first, const VerifiedPose& second, const CommonFloor& common,
                       float max_distance) {
  PairedTest test;
  for (std::size_t i = 0; i < first.distance.size(); ++i) {
    if (common.HasKeypoint(i)) {
      test.Add(Score(first.distance[i], max_distance) - Score(second.distance[i], max_distance));
    }
  }
  return test.Sigma();
}

// Sign test on the distinctive matches that support either pose.
double LeadByVotes(const VerifiedPose& first, const VerifiedPose& second, const CommonFloor& common) {
  const auto votes = [&](const VerifiedPose& pose) {
    return static_cast<double>(
        std::count_if(pose.supporting_keypoints.begin(), pose.supporting_keypoints.end(),
                      [&](int keypoint) { return common.HasKeypoint(static_cast<std::size_t>(keypoint)); }));
  };
  const double for_first = votes(first);
  const double for_second = votes(second);
  return (for_first - for_second) / std::sqrt(std::max(1.0, for_first + for_second));
}

// Fisher's transformation makes the variance of a correlation independent of its value.
double FisherZ(float correlation, double limit) {
  return std::atanh(std::clamp(static_cast<double>(correlation), -limit, limit));
}

double LeadByMosaic(const PhotometricFit& first, const PhotometricFit& second, const CommonFloor& common,
                    double max_correlation) {
  PairedTest test;
  for (std::size_t c = 0; c < first.cell_correlation.size(); ++c) {
    if (common.HasCell(static_cast<int>(c))) {
      test.Add(FisherZ(first.cell_correlation[c], max_correlation) -
               FisherZ(second.cell_correlation[c], max_correlation));
    }
  }
  return test.Sigma();
}

double UpperTail(double sigma) { return std::max(0.5 * std::erfc(sigma / std::numbers::sqrt2), 1e-100); }

// Joint p value of independent tests (Fisher 1925): the chi-square tail of -2 sum(ln p), 2k degrees of freedom.
double FisherP(std::span<const double> p_values) {
  double x = 0.0;
  for (const double p : p_values) {
    x -= std::log(p);
  }
  double term = 1.0;
  double sum = 1.0;
  for (std::size_t k = 1; k < p_values.size(); ++k) {
    term *= x / static_cast<double>(k);
    sum += term;
  }
  return std::exp(-x) * sum;
}

// Odds of the second of two poses by their views: a place whose view agrees is right rather than one that agrees in a
// part of the view. Among confirmed views more agreement does not count again.
double OddsByView(const VerifiedPose& first, const VerifiedPose& second, const DecisionOptions& options) {
  if (!first.view || !second.view) {
    return 1.0;
  }
  const double confirmed = -std::log10(options.clear_p_wrong);
  const auto evidence = [&](const ViewSupport& view) { return std::clamp(view.log10_odds, -confirmed, confirmed); };
  return std::pow(10.0, evidence(*second.view) - evidence(*first.view));
}

// The place of the lattice where a pose is; nullptr: at none, or places were not compared.
const LatticePlace* PlaceOf(const VerifiedPose& pose, const PoseEvidence& evidence) {
  return evidence.lattice == nullptr ? nullptr : evidence.lattice->Find(pose.candidate.target_from_source);
}

// Odds that the second of two poses is right rather than the first. An inconclusive test does not weaken a conclusive
// one; a contradicting one does.
double OddsOfSecond(const VerifiedPose& first, const VerifiedPose& second, const PoseEvidence& evidence,
                    const DecisionOptions& options) {
  const LatticePlace* first_place = PlaceOf(first, evidence);
  const LatticePlace* second_place = PlaceOf(second, evidence);
  if (first_place != nullptr && second_place != nullptr) {  // what discriminates them is in the pixels
    return std::exp(second_place->log_likelihood - first_place->log_likelihood) * second.prior_weight /
           first.prior_weight * OddsByView(first, second, options);
  }
  const CommonFloor common(first, second, evidence.cell_of_keypoint);
  std::vector<double> leads{LeadByKeypoints(first, second, common, evidence.max_distance),
                            LeadByVotes(first, second, common)};
  if (first.photo && second.photo) {
    leads.push_back(LeadByMosaic(*first.photo, *second.photo, common, options.max_correlation));
  }
  std::vector<double> for_first;
  std::vector<double> for_second;
  for (const double lead : leads) {
    for_first.push_back(UpperTail(lead));
    for_second.push_back(UpperTail(-lead));
  }
  return FisherP(for_first) * second.prior_weight * OddsByView(first, second, options) /
         (FisherP(for_second) * first.prior_weight);
}

// log10 of the probability that the frame agrees as well with the mosaic under a wrong pose.
double Log10ChanceOfPhoto(const PhotometricFit& photo, const DecisionOptions& options) {
  const auto cells = std::count_if(photo.cell_samples.begin(), photo.cell_samples.end(), [](int n) { return n > 0; });
  const double sigma =
      photo.TrimmedCorrelation(options.trimmed_share) / options.cell_sigma * std::sqrt(static_cast<double>(cells));
  return sigma > 0.0 ? std::log10(UpperTail(sigma)) : 0.0;
}

// log10 of the probability of such a pose by chance: the weaker of the evidence of all keypoints and the distinctive
// evidence.
double Log10Chance(const VerifiedPose& pose, const PoseEvidence& evidence, const DecisionOptions& options) {
  if (PlaceOf(pose, evidence) != nullptr) {
    return pose.candidate.log10_nfa;  // of the pose but for the place, of which the comparison of places tells
  }
  double distinctive = pose.support_log10_nfa;
  if (pose.photo && !evidence.floor_repeats) {
    distinctive = std::min(distinctive, Log10ChanceOfPhoto(*pose.photo, options));
  }
  return std::max(pose.candidate.log10_nfa, options.structure_exponent * distinctive);
}

// On a self-similar floor: probability that the right pose was not among the candidates and a similar place is
// accepted. A pose becomes a candidate by at least three distinctive matches, whose number is Poisson distributed. The
// whole map is searched by keypoints at their own angles, so those inliers say how many to expect: in hard frames a
// similar place has many more by upright descriptors.
double ChanceOfMissingTheRightPose(const VerifiedPose& pose, const DecisionOptions& options) {
  const int inliers = pose.own_angle_inliers.value_or(static_cast<int>(pose.candidate.inliers.size()));
  const double expected = options.distinctive_share * inliers;
  const double at_most_two = std::exp(-expected) * (1.0 + expected + 0.5 * expected * expected);
  return options.look_alike_taken * at_most_two;
}

// On a lattice: odds of the places that are not among the poses, against that of the best.
double ChanceOfOtherPlaces(const LatticePlace& best, const std::vector<VerifiedPose>& poses,
                           const LatticeComparison& lattice) {
  std::vector<const LatticePlace*> among;
  for (const VerifiedPose& pose : poses) {
    among.push_back(lattice.Find(pose.candidate.target_from_source));
  }
  double odds =
      lattice.not_compared * lattice.prior_weight_elsewhere / best.prior_weight * std::exp(-best.log_likelihood);
  for (const LatticePlace& place : lattice.places) {
    if (std::find(among.begin(), among.end(), &place) == among.end()) {
      odds += place.prior_weight / best.prior_weight * std::exp(place.log_likelihood - best.log_likelihood);
    }
  }
  return std::min(1.0, odds);
}

// odds[i][k]: odds of pose k against pose i.
std::vector<std::vector<double>> OddsOfAll(const std::vector<VerifiedPose>& poses, const PoseEvidence& evidence,
                                           const DecisionOptions& options) {
  std::vector<std::vector<double>> odds(poses.size(), std::vector<double>(poses.size(), 1.0));
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (std::size_t k = i + 1; k < poses.size(); ++k) {
      odds[i][k] = OddsOfSecond(poses[i], poses[k], evidence, options);
      odds[k][i] = 1.0 / odds[i][k];
    }
  }
  return odds;
}

// The pose with the largest weight when the odds of all poses against it are normalised. Pairwise odds need not be
// transitive: each pose is compared with all others, so that their order does not matter.
std::size_t FindBest(const std::vector<std::vector<double>>& odds) {
  std::vector<double> sums;
  for (const std::vector<double>& against : odds) {
    sums.push_back(std::accumulate(against.begin(), against.end(), 0.0));
  }
  return static_cast<std::size_t>(std::min_element(sums.begin(), sums.end()) - sums.begin());
}

}  // namespace

void DecisionOptions::Check() const {
  RequireOption(structure_exponent > 0 && structure_exponent <= 1, "structure_exponent must be above 0 and at most 1");
  RequireOption(cell_sigma > 0 && cell_sigma <= 1, "cell_sigma must be above 0 and at most 1");
  RequireOption(trimmed_share > 0 && trimmed_share <= 1, "trimmed_share must be above 0 and at most 1");
  RequireOption(max_correlation > 0 && max_correlation < 1, "max_correlation must be between 0 and 1");
  RequireOption(distinctive_share > 0 && distinctive_share <= 1, "distinctive_share must be above 0 and at most 1");
  RequireOption(local_share >= 0 && local_share < 1, "local_share must be at least 0 and below 1");
  RequireOption(max_mosaic_coarseness > 0, "max_mosaic_coarseness must be positive");
  RequireOption(look_alike_taken >= 0 && look_alike_taken <= 1, "look_alike_taken must be 0 to 1");
  RequireOption(clear_p_wrong > 0 && clear_p_wrong <= 1, "clear_p_wrong must be above 0 and at most 1");
}

PoseDecision DecidePose(const std::vector<VerifiedPose>& poses, const PoseEvidence& evidence,
                        const RegistrationOptions& registration, const DecisionOptions& options) {
  if (poses.empty()) {
    return {};
  }
  const std::vector<std::vector<double>> odds = OddsOfAll(poses, evidence, options);
  PoseContest contest;
  contest.best = FindBest(odds);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const PoseCandidate& pose = poses[i].candidate;
    const bool counts = i == contest.best || pose.log10_nfa < registration.max_rival_log10_nfa;
    contest.hypotheses.push_back(
        {pose.target_from_source, static_cast<int>(pose.inliers.size()), counts ? odds[contest.best][i] : 0.0});
  }
  const VerifiedPose& best = poses[contest.best];
  contest.p_chance = std::min(1.0, std::pow(10.0, Log10Chance(best, evidence, options)));
  contest.p_local = best.view ? best.view->LocalProbability() : 0.0;
  if (evidence.floor_repeats) {
    const LatticePlace* place = PlaceOf(best, evidence);
    contest.p_missed = place == nullptr ? ChanceOfMissingTheRightPose(best, options)
                                        : ChanceOfOtherPlaces(*place, poses, *evidence.lattice);
  }
  return ChoosePose(contest, registration);
}

}  // namespace floorloc
