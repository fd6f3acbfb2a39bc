// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/dead_reckoning.h"

#include <algorithm>
#include <cmath>

#include "core/fusion/kalman_correction.h"

namespace floorloc {
namespace {

using namespace error_row;  // NOLINT: rows are named all over this file

// The error state, followed by the error of the interval's motion: true motion = motion * Exp(error).
constexpr int kMotion = kCount;
constexpr int kAugmentedCount = kCount + 3;
static_assert(kAugmentedCount <= kMaxErrorRows);
using AugmentedCovariance = Eigen::Matrix<double, kAugmentedCount, kAugmentedCount>;
using MotionJacobian = Eigen::Matrix<double, 3, kCount>;

double Square(double x) { return x * x; }

Eigen::Vector2d Rotate90(const Eigen::Vector2d& v) { return {-v.y(), v.x()}; }

// An interval of time, and the sensors that cover it.
struct Interval {
  std::int64_t from_ns = 0;
  std::int64_t to_ns = 0;
  bool wheels = false;
  bool vision = false;
  bool imu = false;

  double Seconds() const { return 1e-9 * static_cast<double>(to_ns - from_ns); }
};

// A motion as a function of the state, with independent noise.
struct MotionModel {
  Pose2 motion;
  MotionJacobian jacobian = MotionJacobian::Zero();  // of the motion's error by the state's error
  Eigen::Matrix3d noise = Eigen::Matrix3d::Zero();
};

class PropagationStep {
 public:
  PropagationStep(const MotionRecord& record, const PoseFilterOptions& options, const Interval& interval,
                  FilterState* state)
      : record_(record), options_(options), interval_(interval), dt_(interval.Seconds()), state_(*state) {
    if (interval_.imu) {
      imu_ = record_.imu.Between(interval_.from_ns, interval_.to_ns, state_.imu_bias);
    }
  }

  void Run() {
    const MotionModel model = ChooseModel();
    motion_ = model.motion;
    covariance_.setZero();
    covariance_.topLeftCorner<kCount, kCount>() = state_.covariance;
    covariance_.bottomLeftCorner<3, kCount>() = model.jacobian * state_.covariance;
    covariance_.topRightCorner<kCount, 3>() = covariance_.bottomLeftCorner<3, kCount>().transpose();
    covariance_.bottomRightCorner<3, 3>() = PropagateCovariance(model.jacobian, state_.covariance) + model.noise;
    CorrectByImu();
    AddMotion();
  }

 private:
  MotionModel ChooseModel() {
    const TrackMotion said = record_.wheels.Between(interval_.from_ns, interval_.to_ns);
    if (TrustsWheels()) {
      raw_ = said;
      odom_motion_ = said.motion;
      return FromWheels(said);
    }
    MotionModel model = interval_.imu ? FromImu() : FromMotionPrior();
    if (interval_.vision) {
      raw_ = record_.vision.Between(interval_.from_ns, interval_.to_ns);
    } else {
      raw_.motion = model.motion;
      raw_.path_m = model.motion.translation().norm();
      raw_.turn_rad = std::abs(model.motion.yaw());
    }
    odom_motion_ = interval_.wheels ? said.motion : raw_.motion;
    return model;
  }

  bool TrustsWheels() const { return interval_.wheels && record_.trust_wheels; }

  Eigen::Matrix3d StandstillNoise() const {
    const OdometryNoise& o = options_.odometry;
    return dt_ *
           Eigen::Vector3d(Square(o.still_m), Square(o.still_m), Square(o.still_rad)).asDiagonal().toDenseMatrix();
  }

  // The rotation is spread evenly over the interval: an error of it rotates the translation by half as much.
  MotionModel FromWheels(const TrackMotion& raw) const {
    const OdometryBias& bias = state_.odometry_bias;
    const OdometryNoise& o = options_.odometry;
    const double turn = bias.yaw_scale * raw.motion.yaw() + bias.drift_rad_per_m * raw.path_m;
    const Eigen::Matrix2d half_turn = Pose2(0.0, 0.0, 0.5 * turn).rotation();
    const Eigen::Vector2d translation = (1.0 + bias.scale) * (half_turn * raw.motion.translation());
    MotionModel model;
    model.motion = Pose2(translation.x(), translation.y(), raw.motion.yaw() + turn);
    const Eigen::Matrix2d to_end = model.motion.rotation().transpose();
    Eigen::Vector3d turn_jacobian;
    turn_jacobian << 0.5 * (to_end * Rotate90(translation)), 1.0;
    model.jacobian.block<2, 1>(0, kOdometryScale) = to_end * (half_turn * raw.motion.translation());
    model.jacobian.col(kOdometryYawScale) = raw.motion.yaw() * turn_jacobian;
    model.jacobian.col(kOdometryDrift) = raw.path_m * turn_jacobian;
    const double factor = state_.wheel_noise_factor;
    const double turn_variance =
        factor * (Square(o.noise_rad) * raw.path_m + Square(o.noise_rad_per_rad) * raw.turn_rad);
    model.noise = turn_variance * turn_jacobian * turn_jacobian.transpose() + StandstillNoise();
    model.noise.topLeftCorner<2, 2>() += factor * Square(o.noise_m) * raw.path_m * Eigen::Matrix2d::Identity();
    return model;
  }

  double GyroVariance(double yaw) const {
    return Square(options_.imu.gyro) * dt_ + Square(options_.imu.gyro_scale * yaw);
  }

  // Position of the base at the end of the interval in the base frame at its beginning.
  Eigen::Vector2d ImuTranslation() const { return dt_ * state_.velocity_m_s + imu_.position_m; }
  double ImuTranslationVariance() const { return Square(options_.imu.accelerometer) * dt_ * dt_ * dt_ / 3.0; }

  MotionModel FromImu() const {
    const Eigen::Vector2d translation = ImuTranslation();
    MotionModel model;
    model.motion = Pose2(translation.x(), translation.y(), imu_.yaw_rad);
    const Eigen::Matrix2d to_end = model.motion.rotation().transpose();
    model.jacobian.block<2, 2>(0, kVelocity) = dt_ * to_end;
    model.jacobian.block<2, 2>(0, kAccelerationBias) = to_end * imu_.position_by_bias;
    model.jacobian(2, kGyroBias) = -dt_;
    model.noise.diagonal() << ImuTranslationVariance(), ImuTranslationVariance(), GyroVariance(imu_.yaw_rad);
    model.noise += StandstillNoise();
    return model;
  }

  // Images give the point of linearization; CorrectByVision accounts for their covariance.
  MotionModel FromMotionPrior() const {
    const MotionPrior& u = options_.motion_prior;
    MotionModel model;
    double translation_sigma = u.speed_m_s * dt_;
    if (interval_.vision) {
      model.motion = record_.vision.Between(interval_.from_ns, interval_.to_ns).motion;
    } else if (dt_ <= u.coast_s) {
      const Eigen::Vector2d translation = dt_ * state_.velocity_m_s;
      model.motion = Pose2(translation.x(), translation.y(), 0.0);
      model.jacobian.block<2, 2>(0, kVelocity) = dt_ * Eigen::Matrix2d::Identity();
      translation_sigma = 0.5 * u.acceleration_m_s2 * dt_ * dt_;
    }
    model.noise.diagonal() << Square(translation_sigma), Square(translation_sigma), Square(u.yaw_rate_rad_s * dt_);
    model.noise += StandstillNoise();
    return model;
  }

  void CorrectByImu() {
    if (interval_.imu && TrustsWheels()) {
      CorrectByGyro();
      CorrectByAccelerometer();
    }
  }

  // Measurement: yaw by the gyro, less its bias, is the yaw of the motion. Where it contradicts the wheels (slip or a
  // knock) the uncertainty grows by the difference instead.
  void CorrectByGyro() {
    Innovation innovation;
    innovation.residual = ErrorColumn::Constant(1, WrapAngle(imu_.yaw_rad - motion_.yaw()));
    innovation.jacobian = ErrorMatrix::Zero(1, kAugmentedCount);
    innovation.jacobian(0, kMotion + 2) = 1.0;
    innovation.jacobian(0, kGyroBias) = dt_;
    innovation.noise = ErrorMatrix::Constant(1, 1, GyroVariance(imu_.yaw_rad));
    if (Contradicts(innovation)) {
      covariance_(kMotion + 2, kMotion + 2) += Square(innovation.residual(0));
    } else {
      Correct(innovation);
    }
  }

  // Measurement: the translation is that of the initial velocity and the integrated accelerations.
  void CorrectByAccelerometer() {
    Innovation innovation;
    innovation.residual = ImuTranslation() - motion_.translation();
    innovation.jacobian = ErrorMatrix::Zero(2, kAugmentedCount);
    innovation.jacobian.block<2, 2>(0, kMotion) = motion_.rotation();
    innovation.jacobian.block<2, 2>(0, kVelocity) = -dt_ * Eigen::Matrix2d::Identity();
    innovation.jacobian.block<2, 2>(0, kAccelerationBias) = -imu_.position_by_bias;
    innovation.noise = ImuTranslationVariance() * Eigen::Matrix2d::Identity();
    if (Contradicts(innovation)) {
      covariance_.block<2, 2>(kMotion, kMotion) += innovation.residual.squaredNorm() * Eigen::Matrix2d::Identity();
    } else {
      Correct(innovation);
    }
  }

  bool Contradicts(const Innovation& innovation) {
    const bool contradicts = MahalanobisSquared(innovation, covariance_) > options_.max_slip_mahalanobis_squared;
    contradicted_ = contradicted_ || contradicts;
    return contradicts;
  }

  // Kalman correction of state and motion.
  void Correct(const Innovation& innovation) {
    const Correction correction = KalmanCorrection(innovation, covariance_);
    covariance_ = correction.covariance;
    state_.Add(correction.error.head<kCount>());
    motion_ = motion_ * Pose2::Exp(correction.error.tail<3>());
  }

  // Adds the motion to the pose, and its error to the pose's error.
  void AddMotion() {
    Eigen::Matrix<double, kCount, kAugmentedCount> jacobian =
        Eigen::Matrix<double, kCount, kAugmentedCount>::Identity();
    jacobian.block<3, 3>(kPose, kPose) = motion_.Inverse().Adjoint();
    jacobian.block<3, 3>(kPose, kMotion).setIdentity();
    ErrorVector noise = ErrorVector::Zero();
    PropagateVelocity(&jacobian, &noise);
    DecayFixBias(&jacobian, &noise);
    noise(kGyroBias) = Square(options_.imu.gyro_walk) * dt_;
    noise.segment<2>(kAccelerationBias).setConstant(Square(options_.imu.accelerometer_walk) * dt_);
    state_.covariance = PropagateCovariance(jacobian, covariance_);
    state_.covariance.diagonal() += noise;
    state_.covariance = 0.5 * (state_.covariance + state_.covariance.transpose()).eval();
    state_.map_from_base = state_.map_from_base * motion_;
    state_.odom_from_base = state_.odom_from_base * odom_motion_;
    state_.path_m += raw_.path_m;
    state_.turn_rad += raw_.turn_rad;
    state_.stamp_ns = interval_.to_ns;
  }

  // A Gauss-Markov process along the path.
  void DecayFixBias(Eigen::Matrix<double, kCount, kAugmentedCount>* jacobian, ErrorVector* noise) {
    const SharedFixNoise& shared = options_.shared_fix;
    const double decay = std::exp(-raw_.path_m / shared.correlation_m);
    state_.fix_bias *= decay;
    jacobian->middleRows<3>(kFixBias) *= decay;
    noise->segment<3>(kFixBias) = (1.0 - decay * decay) * FixBiasVariance(shared);
  }

  // With an IMU the velocity is integrated. Without, it is the mean velocity of the interval, with the acceleration
  // over half the interval as its uncertainty; without any measurement it is kept for coast_s, then unknown.
  void PropagateVelocity(Eigen::Matrix<double, kCount, kAugmentedCount>* jacobian, ErrorVector* noise) {
    const Eigen::Matrix2d to_end = motion_.rotation().transpose();
    jacobian->middleRows<2>(kVelocity).setZero();
    if (interval_.imu && !contradicted_) {
      state_.velocity_m_s = to_end * (state_.velocity_m_s + imu_.velocity_m_s);
      jacobian->block<2, 2>(kVelocity, kVelocity) = to_end;
      jacobian->block<2, 2>(kVelocity, kAccelerationBias) = to_end * imu_.velocity_by_bias;
      jacobian->block<2, 1>(kVelocity, kMotion + 2) = -Rotate90(state_.velocity_m_s);
      noise->segment<2>(kVelocity).setConstant(Square(options_.imu.accelerometer) * dt_);
    } else if (TrustsWheels() || interval_.vision) {
      state_.velocity_m_s = to_end * motion_.translation() / dt_;
      jacobian->block<2, 2>(kVelocity, kMotion) = Eigen::Matrix2d::Identity() / dt_;
      jacobian->block<2, 1>(kVelocity, kMotion + 2) = -Rotate90(state_.velocity_m_s);
      noise->segment<2>(kVelocity).setConstant(Square(0.5 * options_.motion_prior.acceleration_m_s2 * dt_));
    } else if (dt_ <= options_.motion_prior.coast_s) {
      const double kept = std::exp(-dt_ / options_.motion_prior.forget_s);
      state_.velocity_m_s *= kept;
      jacobian->block<2, 2>(kVelocity, kVelocity) = kept * Eigen::Matrix2d::Identity();
      // Accelerations are those of coast_s each, so that the noise does not depend on how an interval is cut.
      noise->segment<2>(kVelocity).setConstant(Square(options_.motion_prior.acceleration_m_s2) *
                                                   options_.motion_prior.coast_s * dt_ +
                                               (1.0 - kept * kept) * Square(options_.motion_prior.speed_m_s));
    } else {
      state_.velocity_m_s.setZero();
      noise->segment<2>(kVelocity).setConstant(Square(options_.motion_prior.speed_m_s));
    }
  }

  const MotionRecord& record_;
  const PoseFilterOptions& options_;
  const Interval interval_;
  const double dt_;
  FilterState& state_;
  ImuMotion imu_;
  TrackMotion raw_;            // as measured by what is trusted
  Pose2 odom_motion_;          // as wheels say, trusted or not, for the odom frame
  Pose2 motion_;               // as estimated
  bool contradicted_ = false;  // wheels and IMU contradict each other: slip, or a knock
  AugmentedCovariance covariance_ = AugmentedCovariance::Zero();
};

// The longest interval from from_ns on during which the same sensors cover the motion.
Interval NextInterval(const MotionRecord& record, std::int64_t from_ns, std::int64_t to_ns) {
  Interval interval{from_ns, to_ns, false, false, false};
  const auto take = [&](const auto& track, bool* covers) {
    const std::int64_t until = track.CoveredUntil(from_ns, to_ns);
    *covers = until > from_ns;
    const std::int64_t change = *covers ? until : std::max(from_ns, track.NextStart(from_ns, to_ns));
    if (change > from_ns) {
      interval.to_ns = std::min(interval.to_ns, change);
    }
  };
  take(record.wheels, &interval.wheels);
  take(record.vision, &interval.vision);
  if (record.trust_imu) {
    take(record.imu, &interval.imu);
  }
  return interval;
}

}  // namespace

void Propagate(const MotionRecord& record, const PoseFilterOptions& options, std::int64_t to_ns, FilterState* state) {
  while (state->stamp_ns < to_ns) {
    PropagationStep(record, options, NextInterval(record, state->stamp_ns, to_ns), state).Run();
  }
}

}  // namespace floorloc
