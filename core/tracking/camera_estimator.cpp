// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/camera_estimator.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

// All modes together displace a corner by this many times the standard deviation of one: their squares add up to 5.9 at
// a corner of a 4:3 image.
constexpr double kCornerPerMode = 2.43;

constexpr int kTilts = 2;  // the first errors

CameraErrorMatrix PriorInformation(const CameraEstimatorOptions& options) {
  CameraErrors sigma;
  sigma << options.rotation_sigma_rad, options.rotation_sigma_rad, options.height_share_sigma,
      Eigen::Matrix<double, kCalibrationModes, 1>::Constant(options.calibration_sigma_px / kCornerPerMode);
  return sigma.cwiseAbs2().cwiseInverse().asDiagonal();
}

bool IsPlausible(const CameraErrors& errors, const CameraEstimatorOptions& options) {
  return errors.head<kTilts>().norm() <= options.max_rotation_rad && std::abs(errors(2)) <= options.max_height_share &&
         errors.tail<kCalibrationModes>().norm() <= options.max_calibration_px;
}

void AddTo(LearntCamera::Sums* sums, const CameraEvidence& evidence, double memory_fixes) {
  const double kept = 1.0 - 1.0 / memory_fixes;
  sums->information = kept * sums->information + evidence.information;
  sums->pull = kept * sums->pull + evidence.pull;
}

// The evidence of so many fixes, worth no more than CameraEstimatorOptions::independent_fixes.
LearntCamera::Sums Tempered(const LearntCamera::Sums& sums, double fixes, const CameraEstimatorOptions& options) {
  const double share = options.independent_fixes / (options.independent_fixes + fixes);
  return {share * sums.information, share * sums.pull};
}

struct Posterior {
  CameraErrors mean;
  CameraErrorMatrix covariance;
  double significance = 0.0;  // squared Mahalanobis distance of the mean from zero
};

Posterior PosteriorOf(const LearntCamera::Sums& sums, const CameraErrorMatrix& prior) {
  const CameraErrorMatrix information = prior + sums.information;
  const Eigen::LLT<CameraErrorMatrix> factor(information);
  const CameraErrors mean = factor.solve(sums.pull);
  return {mean, factor.solve(CameraErrorMatrix::Identity()), mean.dot(information * mean)};
}

// As if the tilt was known to be zero.
Posterior PosteriorWithoutTilt(LearntCamera::Sums sums, const CameraErrorMatrix& prior) {
  sums.information.topRows<kTilts>().setZero();
  sums.information.leftCols<kTilts>().setZero();
  sums.pull.head<kTilts>().setZero();
  Posterior posterior = PosteriorOf(sums, prior);
  posterior.covariance.topLeftCorner<kTilts, kTilts>().setZero();
  return posterior;
}

}  // namespace

void CameraEstimatorOptions::Check() const {
  RequireOption(rotation_sigma_rad > 0.0, "rotation_sigma_rad must be positive");
  RequireOption(height_share_sigma > 0.0, "height_share_sigma must be positive");
  RequireOption(calibration_sigma_px > 0.0, "calibration_sigma_px must be positive");
  RequireOption(memory_fixes >= 1.0, "memory_fixes must be at least 1");
  RequireOption(min_travel_share >= 0.0, "min_travel_share must not be negative");
  RequireOption(min_turn_rad > 0.0, "min_turn_rad must be positive");
  RequireOption(max_p_wrong > 0.0 && max_p_wrong <= 1.0, "max_p_wrong must be above 0 and at most 1");
  RequireOption(min_fixes >= 1, "min_fixes must be at least 1");
  RequireOption(independent_fixes > 0.0, "independent_fixes must be positive");
  RequireOption(min_significance > 0.0, "min_significance must be positive");
  RequireOption(min_tilt_significance >= 0.0, "min_tilt_significance must not be negative");
  RequireOption(recent_fixes >= 1.0, "recent_fixes must be at least 1");
  RequireOption(bump_significance > 0.0, "bump_significance must be positive");
  RequireOption(max_rotation_rad > 0.0, "max_rotation_rad must be positive");
  RequireOption(max_height_share > 0.0, "max_height_share must be positive");
  RequireOption(max_calibration_px > 0.0, "max_calibration_px must be positive");
}

const char* ToString(CameraStatus status) {
  switch (status) {
    case CameraStatus::kLearning:
      return "learning";
    case CameraStatus::kAsCalibrated:
      return "as_calibrated";
    case CameraStatus::kCorrected:
      return "corrected";
    case CameraStatus::kImplausible:
      return "implausible";
  }
  return "";
}

CameraEstimator::CameraEstimator(const CameraEstimatorOptions& options) : options_(options) { options.Check(); }

bool CameraEstimator::HasMoved(const Pose2& map_from_base, double view_radius_m) const {
  if (!learnt_.last_used) {
    return true;
  }
  const Pose2 motion = learnt_.last_used->Between(map_from_base);
  return motion.translation().norm() >= options_.min_travel_share * view_radius_m ||
         std::abs(motion.yaw()) >= options_.min_turn_rad;
}

// The residual of the newest fixes has the covariance information + information * P * information.
bool CameraEstimator::WasBumped() const {
  const CameraPrior now = Estimate().errors;
  const LearntCamera::Sums recent =
      Tempered(learnt_.recent, std::min<double>(learnt_.fixes, options_.recent_fixes), options_);
  const CameraErrors residual = recent.pull - recent.information * now.mean;
  const CameraErrorMatrix covariance = recent.information + recent.information * now.covariance * recent.information;
  return residual.dot(covariance.ldlt().solve(residual)) > options_.bump_significance;
}

void CameraEstimator::Add(const CameraEvidence& evidence, const Pose2& map_from_base, double p_wrong) {
  if (evidence.camera != learnt_.camera) {
    learnt_ = LearntCamera();
    learnt_.camera = evidence.camera;
  }
  if (p_wrong > options_.max_p_wrong || !HasMoved(map_from_base, evidence.view_radius_m)) {
    return;
  }
  AddTo(&learnt_.all, evidence, options_.memory_fixes);
  AddTo(&learnt_.recent, evidence, options_.recent_fixes);
  learnt_.last_used = map_from_base;
  ++learnt_.fixes;
  if (learnt_.fixes > 2 * options_.min_fixes && WasBumped()) {
    learnt_.all = learnt_.recent;
    learnt_.fixes = options_.min_fixes;
  }
}

CameraEstimate CameraEstimator::Estimate() const {
  const LearntCamera::Sums sums =
      Tempered(learnt_.all, std::min<double>(learnt_.fixes, options_.memory_fixes), options_);
  const CameraErrorMatrix prior = PriorInformation(options_);
  Posterior posterior = PosteriorOf(sums, prior);
  const Posterior without_tilt = PosteriorWithoutTilt(sums, prior);
  const bool tilted = posterior.significance - without_tilt.significance >= options_.min_tilt_significance;
  posterior = tilted ? posterior : without_tilt;
  // What the fixes share makes the errors uncertain; their mean is still by all of them.
  posterior.mean = tilted ? PosteriorOf(learnt_.all, prior).mean : PosteriorWithoutTilt(learnt_.all, prior).mean;
  CameraEstimate estimate;
  estimate.fixes = learnt_.fixes;
  estimate.errors = {posterior.mean, posterior.covariance, learnt_.camera};
  if (learnt_.fixes < options_.min_fixes) {
    estimate.status = CameraStatus::kLearning;
  } else if (!IsPlausible(posterior.mean, options_)) {
    estimate.status = CameraStatus::kImplausible;
  } else {
    estimate.status =
        posterior.significance >= options_.min_significance ? CameraStatus::kCorrected : CameraStatus::kAsCalibrated;
  }
  return estimate;
}

std::optional<CameraPrior> CameraEstimator::PriorOfNextFrame() const {
  const CameraEstimate estimate = Estimate();
  return estimate.status == CameraStatus::kCorrected ? std::optional(estimate.errors) : std::nullopt;
}

}  // namespace floorloc
