// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/fix_gate.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/fusion/kalman_correction.h"

namespace floorloc {
namespace {

FixRejection FirstClosedGate(const FixOutcome& fix, double p_wrong, const FilterState& predicted,
                             const FixGates& gates) {
  const double position_sigma_m = LargestSigma(predicted.covariance.topLeftCorner<2, 2>());
  const double yaw_sigma_rad = std::sqrt(predicted.covariance(2, 2));
  if (p_wrong > gates.max_p_wrong) {
    return FixRejection::kWrongFixRisk;
  }
  if (fix.distance_m > std::max(gates.max_distance_m, gates.sigmas * position_sigma_m)) {
    return FixRejection::kJumpDistance;
  }
  if (fix.angle_rad > std::max(gates.max_angle_rad, gates.sigmas * yaw_sigma_rad)) {
    return FixRejection::kJumpAngle;
  }
  return fix.mahalanobis_squared > gates.max_mahalanobis_squared ? FixRejection::kMahalanobis : FixRejection::kNone;
}

}  // namespace

FixOutcome JudgeFix(const PoseFix& fix, const FilterState& predicted, const FixGates& gates) {
  const Pose2 jump = predicted.map_from_base.Between(fix.map_from_base);
  const Eigen::Vector3d innovation = jump.Log();
  const Eigen::Matrix3d covariance =
      predicted.covariance.topLeftCorner<3, 3>() + ToBaseFrame(fix.covariance, fix.map_from_base);
  FixOutcome outcome;
  outcome.distance_m = jump.translation().norm();
  outcome.angle_rad = std::abs(jump.yaw());
  outcome.mahalanobis_squared = innovation.dot(covariance.ldlt().solve(innovation));
  outcome.reason = FirstClosedGate(outcome, fix.p_wrong, predicted, gates);
  outcome.accepted = outcome.reason == FixRejection::kNone;
  return outcome;
}

void CorrectByFix(const PoseFix& fix, FilterState* state) {
  using Jacobian = Eigen::Matrix<double, 3, error_row::kCount>;
  const Jacobian jacobian = Jacobian::Identity();
  const Eigen::Matrix3d noise = ToBaseFrame(fix.covariance, fix.map_from_base);
  const Eigen::Vector3d residual = state->map_from_base.Between(fix.map_from_base).Log();
  state->Add(KalmanCorrection<3, error_row::kCount>(residual, jacobian, noise, &state->covariance));
}

bool IsValid(const PoseFix& fix) {
  return fix.map_from_base.IsFinite() && std::isfinite(fix.p_wrong) && fix.covariance.allFinite() &&
         Eigen::LLT<Eigen::Matrix3d>(fix.covariance).info() == Eigen::Success;
}

}  // namespace floorloc
