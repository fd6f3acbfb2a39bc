// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/fix_gate.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/fusion/kalman_correction.h"

namespace floorloc {
namespace {

// After a shorter path since the last fix the innovation hardly depends on the noise of the wheels.
constexpr double kMinPathM = 0.005;

// One innovation in 25 is smaller. Noise that was raised after a contradiction falls faster than it adapts.
constexpr double kFarTooSmall = 0.3;
constexpr int kFasterDown = 3;

FixRejection FirstFailedGate(const FixOutcome& fix, double p_wrong, const FilterState& predicted,
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

Innovation ComputeInnovation(const PoseFix& fix, const FilterState& state) {
  Innovation innovation;
  innovation.jacobian = ErrorMatrix::Zero(3, error_row::kCount);
  innovation.residual = (state.map_from_base * Pose2::Exp(state.fix_bias)).Between(fix.map_from_base).Log();
  innovation.jacobian.block<3, 3>(0, error_row::kPose).setIdentity();
  innovation.jacobian.block<3, 3>(0, error_row::kFixBias).setIdentity();
  innovation.noise = ToBaseFrame(fix.covariance, fix.map_from_base);
  return innovation;
}

double MahalanobisOf(const PoseFix& fix, const FilterState& predicted) {
  return MahalanobisSquared(ComputeInnovation(fix, predicted), predicted.covariance);
}

}  // namespace

FixOutcome GateFix(const PoseFix& fix, const FilterState& predicted, const FixGates& gates) {
  const Pose2 jump = predicted.map_from_base.Between(fix.map_from_base);
  FixOutcome outcome;
  outcome.distance_m = jump.translation().norm();
  outcome.angle_rad = std::abs(jump.yaw());
  outcome.mahalanobis_squared = MahalanobisOf(fix, predicted);
  outcome.reason = FirstFailedGate(outcome, fix.p_wrong, predicted, gates);
  outcome.accepted = outcome.reason == FixRejection::kNone;
  return outcome;
}

void AdaptWheelNoise(const PoseFix& fix, const NoiseAdaptation& adaptation, FilterState* predicted) {
  if (predicted->path_m < kMinPathM) {
    return;
  }
  const double mahalanobis_squared = MahalanobisOf(fix, *predicted);
  const bool was_raised = predicted->wheel_noise_factor > 1.0 && mahalanobis_squared < kFarTooSmall;
  for (int i = 0; i < (was_raised ? kFasterDown : 1); ++i) {
    predicted->wheel_noise_factor = AdaptNoiseFactor(predicted->wheel_noise_factor, mahalanobis_squared, adaptation);
  }
}

void CorrectByFix(const PoseFix& fix, FilterState* state) {
  const Correction correction = KalmanCorrection(ComputeInnovation(fix, *state), state->covariance);
  state->covariance = correction.covariance;
  state->Add(correction.error);
}

void ResetToFix(const PoseFix& fix, const SharedFixNoise& shared, FilterState* state) {
  const Eigen::Matrix3d bias = FixBiasVariance(shared).asDiagonal();
  ResetPose(fix.map_from_base, ToBaseFrame(fix.covariance, fix.map_from_base) + bias, state);
  state->fix_bias.setZero();
  state->covariance.middleRows<3>(error_row::kFixBias).setZero();
  state->covariance.middleCols<3>(error_row::kFixBias).setZero();
  state->covariance.block<3, 3>(error_row::kFixBias, error_row::kFixBias) = bias;
  state->covariance.block<3, 3>(error_row::kFixBias, error_row::kPose) = -bias;
  state->covariance.block<3, 3>(error_row::kPose, error_row::kFixBias) = -bias;
}

void ResetPose(const Pose2& map_from_base, const Eigen::Matrix3d& covariance, FilterState* state) {
  state->map_from_base = map_from_base;
  state->covariance.topRows<3>().setZero();
  state->covariance.leftCols<3>().setZero();
  state->covariance.topLeftCorner<3, 3>() = covariance;
  state->visual_ns.reset();
}

bool IsValid(const PoseFix& fix) {
  return fix.map_from_base.IsFinite() && std::isfinite(fix.p_wrong) && fix.covariance.allFinite() &&
         Eigen::LLT<Eigen::Matrix3d>(fix.covariance).info() == Eigen::Success;
}

}  // namespace floorloc
