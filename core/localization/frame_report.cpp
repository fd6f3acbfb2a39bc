// SPDX-License-Identifier: Apache-2.0
#include "core/localization/frame_report.h"

#include <algorithm>
#include <cmath>

#include "core/registration/least_squares.h"
#include "core/registration/systematic_covariance.h"

namespace floorloc {
namespace {

NotLocalizedReason ReasonOf(RegistrationStatus status) {
  switch (status) {
    case RegistrationStatus::kTooFewMatches:
      return NotLocalizedReason::kTooFewMatches;
    case RegistrationStatus::kTooFewInliers:
      return NotLocalizedReason::kTooFewInliers;
    case RegistrationStatus::kNotSignificant:
      return NotLocalizedReason::kNotSignificant;
    case RegistrationStatus::kViewDisagrees:
      return NotLocalizedReason::kViewDisagrees;
    case RegistrationStatus::kRegistered:
    case RegistrationStatus::kAmbiguous:
      return NotLocalizedReason::kNone;
  }
  return NotLocalizedReason::kNone;
}

LocalizationStatus StatusOf(RegistrationStatus status) {
  switch (status) {
    case RegistrationStatus::kRegistered:
      return LocalizationStatus::kLocalized;
    case RegistrationStatus::kAmbiguous:
      return LocalizationStatus::kAmbiguous;
    default:
      return LocalizationStatus::kNotLocalized;
  }
}

void FillPose(const VerifiedPose& best, const FrameObservation& frame, const LocalizerOptions& options,
              LocalizationResult* result) {
  const Pose2& pose = best.candidate.target_from_source;
  result->map_from_base = pose;
  result->matches = static_cast<int>(best.matches.size());
  result->inliers = static_cast<int>(best.candidate.inliers.size());
  result->rms_m = RmsResidual(best.matches, best.candidate.inliers, pose);
  const double noise_m = KeypointNoise(result->rms_m, result->inliers, options.registration);
  result->covariance = PoseCovariance(best.matches, best.candidate.inliers, pose, noise_m);
  double systematic_m = std::hypot(options.systematic_m, options.systematic_share * result->rms_m);
  if (best.photo && Agrees(*best.photo, options)) {
    result->map_from_base = best.photo->map_from_base;
    result->covariance = best.photo->covariance;
    result->camera = best.photo->camera;
    systematic_m = options.systematic_m;
  }
  // Errors that residuals do not show: those of the map shift and rotate the visible floor as a whole.
  result->covariance += SystematicCovariance(result->map_from_base, result->map_from_base * frame.samples.center(),
                                             {systematic_m, systematic_m / options.systematic_lever_m});
  // The camera's place in the robot: no image shows its error, which is the same in all frames.
  result->covariance.topLeftCorner<2, 2>().diagonal().array() += frame.offset_sigma_m * frame.offset_sigma_m;
}

}  // namespace

bool Agrees(const PhotometricFit& photo, const LocalizerOptions& options) {
  return photo.MeanCorrelation() >= options.photometric.min_correlation &&
         photo.moved_m <= options.photometric.max_correction_radii * options.registration.inlier_radius_m;
}

void FillResult(const FrameObservation& frame, const DecidedSearch& search, const LocalizerOptions& options,
                LocalizationResult* result) {
  const PoseDecision& decision = search.decision;
  result->status = StatusOf(decision.status);
  result->reason = ReasonOf(decision.status);
  result->p_wrong = decision.p_wrong;
  result->alternatives = decision.alternatives;
  if (decision.best < 0) {
    return;
  }
  const VerifiedPose& best = search.poses[static_cast<std::size_t>(decision.best)];
  if (best.outside_prior) {
    result->status = LocalizationStatus::kNotLocalized;
    result->reason = NotLocalizedReason::kContradictsPrior;
    result->p_wrong = 1.0;
    return;
  }
  FillPose(best, frame, options, result);
  if (best.view) {
    result->support_area = best.view->area;
  }
}

std::optional<LatticeObservation> ObserveLattice(const FrameObservation& frame, const DecidedSearch& search,
                                                 const std::optional<LatticeComparison>& compared,
                                                 const LocalizerOptions& options) {
  if (search.decision.best < 0) {
    return std::nullopt;
  }
  const VerifiedPose& best = search.poses[static_cast<std::size_t>(search.decision.best)];
  if (!best.photo || !Agrees(*best.photo, options)) {
    return std::nullopt;
  }
  LocalizationResult filled;
  FillPose(best, frame, options, &filled);
  LatticeObservation observation;
  observation.map_from_base = filled.map_from_base;
  observation.covariance = filled.covariance;
  observation.p_wrong = std::min(1.0, std::pow(10.0, best.candidate.log10_nfa));
  if (best.view) {
    observation.p_wrong = std::max(observation.p_wrong, best.view->LocalProbability());
  }
  observation.by_prior = search.scope.IsUnquestioned(options.search);
  observation.view_center = frame.samples.center();
  observation.view_area_m2 = frame.roi.width_m() * frame.roi.height_m();
  if (compared && compared->Find(best.candidate.target_from_source) != nullptr) {
    observation.places = compared->places;
    const auto origin = std::find_if(observation.places.begin(), observation.places.end(),
                                     [](const LatticePlace& place) { return place.multiples.isZero(); });
    observation.map_from_base = origin->map_from_base;
  }
  return observation;
}

}  // namespace floorloc
