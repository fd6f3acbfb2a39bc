// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/camera_estimator.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

// All modes together displace a corner by this many times the standard deviation of one: their squares add up to 5.9 at
// a corner of a 4:3 image.
constexpr double kCornerPerMode = 2.43;

CameraErrorMatrix PriorInformation(const CameraEstimatorOptions& options) {
  CameraErrors sigma;
  sigma << options.rotation_sigma_rad, options.rotation_sigma_rad, options.height_share_sigma,
      Eigen::Matrix<double, kCalibrationModes, 1>::Constant(options.calibration_sigma_px / kCornerPerMode);
  return sigma.cwiseAbs2().cwiseInverse().asDiagonal();
}

bool IsPlausible(const CameraErrors& errors, const CameraEstimatorOptions& options) {
  return errors.head<2>().norm() <= options.max_rotation_rad && std::abs(errors(2)) <= options.max_height_share &&
         errors.tail<kCalibrationModes>().norm() <= options.max_calibration_px;
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
  RequireOption(min_significance > 0.0, "min_significance must be positive");
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
  if (!last_used_) {
    return true;
  }
  const Pose2 motion = last_used_->Between(map_from_base);
  return motion.translation().norm() >= options_.min_travel_share * view_radius_m ||
         std::abs(motion.yaw()) >= options_.min_turn_rad;
}

void CameraEstimator::Sums::Add(const CameraEvidence& evidence, double memory_fixes) {
  const double kept = 1.0 - 1.0 / memory_fixes;
  information = kept * information + evidence.information;
  pull = kept * pull + evidence.pull;
}

// The residual of the newest fixes has the covariance information + information * P * information.
bool CameraEstimator::WasBumped() const {
  const CameraPrior now = Estimate().errors;
  const CameraErrors residual = recent_.pull - recent_.information * now.mean;
  const CameraErrorMatrix covariance = recent_.information + recent_.information * now.covariance * recent_.information;
  return residual.dot(covariance.ldlt().solve(residual)) > options_.bump_significance;
}

void CameraEstimator::Add(const CameraEvidence& evidence, const Pose2& map_from_base, double p_wrong) {
  if (evidence.camera != camera_) {
    *this = CameraEstimator(options_);
    camera_ = evidence.camera;
  }
  if (p_wrong > options_.max_p_wrong || !HasMoved(map_from_base, evidence.view_radius_m)) {
    return;
  }
  all_.Add(evidence, options_.memory_fixes);
  recent_.Add(evidence, options_.recent_fixes);
  last_used_ = map_from_base;
  ++fixes_;
  if (fixes_ > 2 * options_.min_fixes && WasBumped()) {
    all_ = recent_;
    fixes_ = options_.min_fixes;
  }
}

CameraEstimate CameraEstimator::Estimate() const {
  const Eigen::LLT<CameraErrorMatrix> information(PriorInformation(options_) + all_.information);
  CameraEstimate estimate;
  estimate.fixes = fixes_;
  estimate.errors = {information.solve(all_.pull), information.solve(CameraErrorMatrix::Identity()), camera_};
  const CameraErrors& errors = estimate.errors.mean;
  if (fixes_ < options_.min_fixes) {
    estimate.status = CameraStatus::kLearning;
  } else if (!IsPlausible(errors, options_)) {
    estimate.status = CameraStatus::kImplausible;
  } else {
    const double significance = errors.dot((PriorInformation(options_) + all_.information) * errors);
    estimate.status =
        significance >= options_.min_significance ? CameraStatus::kCorrected : CameraStatus::kAsCalibrated;
  }
  return estimate;
}

std::optional<CameraPrior> CameraEstimator::PriorOfNextFrame() const {
  const CameraEstimate estimate = Estimate();
  return estimate.status == CameraStatus::kCorrected ? std::optional(estimate.errors) : std::nullopt;
}

}  // namespace floorloc
