// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "core/fusion/filter_options.h"
#include "core/fusion/imu_track.h"
#include "core/geometry/pose2.h"

namespace floorloc {

/// Systematic errors of wheel odometry: true distance = (1 + scale) * measured, true turn = (1 + yaw_scale) * measured
/// + drift_rad_per_m * path.
struct OdometryBias {
  double scale = 0.0;
  double yaw_scale = 0.0;
  double drift_rad_per_m = 0.0;
};

/// Rows of the error state. The pose's error xi lives in the tangent space of the base frame: true = estimate *
/// Exp(xi); the other errors are true - estimate.
namespace error_row {
constexpr int kPose = 0;      // 3
constexpr int kVelocity = 3;  // 2
constexpr int kGyroBias = 5;
constexpr int kAccelerationBias = 6;  // 2
constexpr int kOdometryScale = 8;
constexpr int kOdometryYawScale = 9;
constexpr int kOdometryDrift = 10;
constexpr int kVisionScale = 11;
constexpr int kVisual = 12;   // 3
constexpr int kFixBias = 15;  // 3
constexpr int kCount = 18;
}  // namespace error_row

using ErrorVector = Eigen::Matrix<double, error_row::kCount, 1>;
using ErrorCovariance = Eigen::Matrix<double, error_row::kCount, error_row::kCount>;

/// State of the filter at one time.
struct FilterState {
  std::int64_t stamp_ns = 0;
  Pose2 map_from_base;
  Eigen::Vector2d velocity_m_s = Eigen::Vector2d::Zero();  ///< base frame
  ImuBias imu_bias;
  OdometryBias odometry_bias;
  double vision_scale = 0.0;  ///< true distance = (1 + vision_scale) * measured by images
  /// Pose of the base by visual odometry at the last image. Its drift relative to map_from_base is slow, while each
  /// image has an independent error (vibration); estimating both poses keeps the correlation of consecutive motions.
  Pose2 visual_map_from_base;
  std::optional<std::int64_t> visual_ns;               ///< time of that image; empty: there was none
  Eigen::Vector3d fix_bias = Eigen::Vector3d::Zero();  ///< common error of nearby fixes; tangent space
  ErrorCovariance covariance = ErrorCovariance::Zero();
  /// Factor on the variances of OdometryNoise::noise_*, estimated from the innovations of the fixes.
  double wheel_noise_factor = 1.0;
  double vision_noise_factor = 1.0;  ///< likewise, of VisionNoise::frame_*, from the innovations of the images
  // Propagated, but not estimated:
  Pose2 odom_from_base;
  double path_m = 0.0;    ///< since the last accepted fix
  double turn_rad = 0.0;  ///< likewise

  /// Covariance of (x, y, yaw), additive in the map frame.
  Eigen::Matrix3d MapCovariance() const;
  /// Applies an estimated error to the state.
  void Add(const ErrorVector& error);
};

/// Converts a covariance that is additive in (x, y, yaw) to that of xi in pose * Exp(xi).
Eigen::Matrix3d ToBaseFrame(const Eigen::Matrix3d& additive, const Pose2& pose);

/// Stationary variance of the common error: x, y, yaw.
Eigen::Vector3d FixBiasVariance(const SharedFixNoise& noise);

/// Updates the factor of a noise variance after a measurement: raises it when the innovation is larger than expected,
/// lowers it when it is smaller (covariance matching). mahalanobis_squared: with 3 degrees of freedom.
double AdaptNoiseFactor(double factor, double mahalanobis_squared, const NoiseAdaptation& adaptation);

/// Standard deviation along the longer axis.
double LargestSigma(const Eigen::Matrix2d& covariance);

}  // namespace floorloc
