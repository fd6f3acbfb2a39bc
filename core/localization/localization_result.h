// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/lattice/lattice_observation.h"
#include "core/localization/readout_fit.h"
#include "core/photometry/camera_errors.h"
#include "core/registration/registration.h"

namespace floorloc {

enum class LocalizationStatus { kLocalized, kAmbiguous, kNotLocalized };
/// "localized", "ambiguous", "not_localized"
const char* ToString(LocalizationStatus status);

/// Why a frame was not localized.
enum class NotLocalizedReason {
  kNone,
  kTooFewKeypoints,
  kTooFewMatches,
  kTooFewInliers,
  kNotSignificant,
  kContradictsPrior,  ///< the frame fits better outside the prior
  kViewDisagrees,     ///< keypoints match in one part of the view, the rest of it does not agree with the map
  kNoFloor,           ///< the view shows no floor: darkness, glare, a lens cap, or things
  kOtherFloor,        ///< it shows a floor of a texture that the map does not have
};
/// "", "too_few_keypoints", "too_few_matches", "too_few_inliers", "not_significant", "contradicts_prior",
/// "view_disagrees", "no_floor", "other_floor"
const char* ToString(NotLocalizedReason reason);

/// Milliseconds of wall time.
struct LocalizationTiming {
  double rectify_ms = 0.0;
  double features_ms = 0.0;
  double match_ms = 0.0;
  double register_ms = 0.0;
  double total_ms = 0.0;

  LocalizationTiming& operator+=(const LocalizationTiming& other) {
    rectify_ms += other.rectify_ms;
    features_ms += other.features_ms;
    match_ms += other.match_ms;
    register_ms += other.register_ms;
    total_ms += other.total_ms;
    return *this;
  }
};

struct LocalizationResult {
  LocalizationStatus status = LocalizationStatus::kNotLocalized;
  NotLocalizedReason reason = NotLocalizedReason::kNone;
  Pose2 map_from_base;  ///< when localized; else the best pose that was not accepted, if there are inliers
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< x, y, yaw; additive, map frame; m^2, m rad, rad^2
  int keypoints = 0;
  int matches = 0;
  int inliers = 0;
  double rms_m = 0.0;    ///< residual of the inliers under the pose by keypoints
  double p_wrong = 1.0;  ///< probability that map_from_base is wrong
  /// Share of the view's cells that agree with the mosaic under map_from_base, of those that can be compared with it;
  /// none: the frame was not compared with a mosaic.
  std::optional<double> support_area;
  bool used_prior = false;
  std::optional<int> poor_jpeg_quality;       ///< of an image whose compression may be why it is not localized
  std::optional<CameraEvidence> camera;       ///< where the frame was aligned to the mosaic
  std::optional<ReadoutMeasurement> readout;  ///< where the image was used to measure its camera's read-out
  std::vector<PoseHypothesis> alternatives;   ///< as in PoseDecision
  /// On a floor that repeats itself: the pose modulo the lattice, whether or not the frame tells its place.
  std::optional<LatticeObservation> lattice;
  LocalizationTiming timing;
};

}  // namespace floorloc
