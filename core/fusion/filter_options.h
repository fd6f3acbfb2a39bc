// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace floorloc {

/// Errors of wheel odometry. They are estimated as the fixes come in; here is how large the systematic ones may be, and
/// the initial noise.
struct OdometryNoise {
  double scale = 0.02;              ///< of distances, standard deviation
  double yaw_scale = 0.02;          ///< of turns
  double drift_rad_per_m = 0.005;   ///< turn that a straight path makes up
  double noise_m = 0.004;           ///< after one metre, growing with the root of the path
  double noise_rad = 0.007;         ///< after one metre, likewise
  double noise_rad_per_rad = 0.01;  ///< after a turn of one radian, growing with the root of the turn
  double still_m = 2e-4;            ///< after one second, moving or not
  double still_rad = 2e-4;
};

/// Errors of visual odometry that its covariances do not include.
struct VisionNoise {
  double scale = 0.003;   ///< of distances: the camera's height over the floor, standard deviation
  double frame_m = 2e-3;  ///< of each image by itself, at first: the camera vibrates
  double frame_rad = 1.5e-3;
};

/// Errors of an IMU, per root of the sampling rate as data sheets have them.
struct ImuNoise {
  double gyro = 1e-3;           ///< rad/s per root Hz; vibration included
  double gyro_bias = 0.02;      ///< rad/s, standard deviation at the start
  double gyro_walk = 1e-4;      ///< rad/s per root s
  double gyro_scale = 0.003;    ///< of turns
  double accelerometer = 0.03;  ///< m/s^2 per root Hz; vibration included
  double accelerometer_bias = 0.2;
  double accelerometer_walk = 2e-3;  ///< m/s^2 per root s; slopes of the floor included
};

/// How the noises of wheels and images are adapted to the residuals (covariance matching).
struct NoiseAdaptation {
  double rate = 0.1;         ///< per measurement; 0: never
  double min_factor = 0.05;  ///< of the variance
  double max_factor = 100.0;
};

/// Errors that fixes of one place share (the map's, the camera's): they do not average out while a vehicle stands
/// still.
struct SharedFixNoise {
  double sigma_m = 2e-4;
  double sigma_rad = 3e-4;
  double correlation_m = 0.2;  ///< after this path the errors are others
};

/// Assumed motion of a vehicle while no sensor measures it (constant velocity, then a random walk).
struct MotionPrior {
  double acceleration_m_s2 = 1.0;  ///< how fast its velocity changes
  double speed_m_s = 0.5;
  double yaw_rate_rad_s = 0.5;
  double coast_s = 0.5;  ///< its velocity is assumed constant for this long
};

/// Which fixes are accepted.
struct FixGates {
  double max_distance_m = 0.20;                ///< jump from the predicted pose (thesis, 3.3.8)
  double max_angle_rad = 0.17453292519943295;  ///< 10 degrees
  /// A prediction that is more uncertain than the two allow for this many standard deviations widens them.
  double sigmas = 4.0;
  double max_mahalanobis_squared = 25.0;  ///< chi-square, 3 degrees of freedom: 1.5e-5 of the right fixes are beyond
  double max_p_wrong = 1e-4;
};

/// When a vehicle is taken to have been kidnapped: so many fixes in a row contradict its pose and agree with each
/// other according to odometry.
struct KidnapOptions {
  int fixes = 3;
  int near_fixes = 2;            ///< when the last one is within the distance and angle gates: wheels slip now and then
  double max_distance_m = 0.05;  ///< disagreement of two of these fixes
  double max_angle_rad = 0.06;
  double sigmas = 3.0;      ///< and so many standard deviations of the motion between them
  double max_age_s = 10.0;  ///< older contradictions are forgotten
};

/// Classes of accuracy of a pose; standard deviations.
struct FilterLimits {
  double localized_m = 0.01;
  double localized_rad = 0.0175;
  double lost_m = 0.5;
  double lost_rad = 0.35;
};

struct PoseFilterOptions {
  OdometryNoise odometry;
  NoiseAdaptation adaptation;
  VisionNoise vision;
  ImuNoise imu;
  SharedFixNoise shared_fix;
  MotionPrior motion_prior;
  FixGates gates;
  KidnapOptions kidnap;
  FilterLimits limits;
  /// Where images or IMU contradict the wheels by more than this (Mahalanobis, squared), the wheels slip.
  double max_slip_mahalanobis_squared = 25.0;
  double history_s = 5.0;           ///< a message that is later than this is ignored
  std::size_t max_messages = 4096;  ///< remembered of each kind
  int clock_jump_messages = 5;      ///< so many messages in a row from before the history: the clock was set

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
};

}  // namespace floorloc
