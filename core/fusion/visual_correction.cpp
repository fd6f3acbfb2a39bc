// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/visual_correction.h"

#include "core/fusion/kalman_correction.h"

namespace floorloc {
namespace {

using namespace error_row;  // NOLINT: rows are named all over this file

Eigen::Matrix3d FrameNoise(const VisionNoise& noise) {
  const Eigen::Vector3d sigma(noise.frame_m, noise.frame_m, noise.frame_rad);
  return sigma.cwiseAbs2().asDiagonal();
}

// Initializes the visual pose with that of the base, plus the noise of this image.
void InitializeVisualPose(const Eigen::Matrix3d& frame_noise, FilterState* state) {
  ErrorCovariance jacobian = ErrorCovariance::Identity();
  jacobian.block<3, 3>(kVisual, kVisual).setZero();
  jacobian.block<3, 3>(kVisual, kPose).setIdentity();
  state->covariance = PropagateCovariance(jacobian, state->covariance);
  state->covariance.block<3, 3>(kVisual, kVisual) += frame_noise;
  state->visual_map_from_base = state->map_from_base;
}

void PropagateVisualPose(const MotionIncrement& increment, FilterState* state) {
  const Eigen::Vector2d translation = (1.0 + state->vision_scale) * increment.motion.translation();
  const Pose2 motion(translation.x(), translation.y(), increment.motion.yaw());
  ErrorCovariance jacobian = ErrorCovariance::Identity();
  jacobian.block<3, 3>(kVisual, kVisual) = motion.Inverse().Adjoint();
  jacobian.block<2, 1>(kVisual, kVisionScale) = motion.rotation().transpose() * increment.motion.translation();
  state->covariance = PropagateCovariance(jacobian, state->covariance);
  if (increment.covariance) {
    state->covariance.block<3, 3>(kVisual, kVisual) += ToBaseFrame(*increment.covariance, motion);
  }
  state->visual_map_from_base = state->visual_map_from_base * motion;
}

}  // namespace

void CorrectByVision(const MotionIncrement& motion, const PoseFilterOptions& options, FilterState* state) {
  const Eigen::Matrix3d frame_noise = state->vision_noise_factor * FrameNoise(options.vision);
  const bool continues = state->visual_ns == motion.from_ns;
  state->visual_ns = motion.to_ns;
  if (!continues) {
    InitializeVisualPose(frame_noise, state);
    return;
  }
  PropagateVisualPose(motion, state);
  const Eigen::Vector3d residual = state->map_from_base.Between(state->visual_map_from_base).Log();
  Innovation innovation{residual, ErrorMatrix::Zero(3, kCount), frame_noise};
  innovation.jacobian.block<3, 3>(0, kPose).setIdentity();
  innovation.jacobian.block<3, 3>(0, kVisual) = -Eigen::Matrix3d::Identity();
  const double mahalanobis_squared = MahalanobisSquared(innovation, state->covariance);
  if (mahalanobis_squared > options.max_slip_mahalanobis_squared) {
    state->covariance.diagonal().segment<3>(kPose) += residual.cwiseAbs2();
  }
  state->vision_noise_factor = AdaptNoiseFactor(state->vision_noise_factor, mahalanobis_squared, options.adaptation);
  const Correction correction = KalmanCorrection(innovation, state->covariance);
  state->covariance = correction.covariance;
  state->Add(correction.error);
}

}  // namespace floorloc
