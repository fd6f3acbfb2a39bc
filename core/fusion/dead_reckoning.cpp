// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/dead_reckoning.h"

#include <algorithm>
#include <cmath>

#include "core/fusion/kalman_correction.h"

namespace floorloc {
namespace {

using namespace error_row;  // NOLINT: rows are named all over this file

// The error state with, behind it, that of the stretch's motion: true motion = motion * Exp(error).
constexpr int kMotion = kCount;
constexpr int kAll = kCount + 3;
using AllErrors = Eigen::Matrix<double, kAll, 1>;
using AllCovariance = Eigen::Matrix<double, kAll, kAll>;
using MotionByState = Eigen::Matrix<double, 3, kCount>;

double Square(double x) { return x * x; }

Eigen::Vector2d QuarterTurn(const Eigen::Vector2d& v) { return {-v.y(), v.x()}; }

// A stretch of time, and what is known of the motion in it.
struct Stretch {
  std::int64_t from_ns = 0;
  std::int64_t to_ns = 0;
  bool wheels = false;
  bool vision = false;
  bool imu = false;

  double Seconds() const { return 1e-9 * static_cast<double>(to_ns - from_ns); }
};

// A motion as a function of the state, with noise of its own.
struct MotionModel {
  Pose2 motion;
  MotionByState by_state = MotionByState::Zero();  // derivative of the motion's error by the state's
  Eigen::Matrix3d noise = Eigen::Matrix3d::Zero();
};

class Step {
 public:
  Step(const MotionRecord& record, const PoseFilterOptions& options, const Stretch& stretch, FilterState* state)
      : record_(record), options_(options), stretch_(stretch), dt_(stretch.Seconds()), state_(*state) {
    if (stretch_.imu) {
      imu_ = record_.imu.Between(stretch_.from_ns, stretch_.to_ns, state_.imu_bias);
    }
  }

  void Run() {
    const MotionModel model = ChooseModel();
    motion_ = model.motion;
    covariance_.setZero();
    covariance_.topLeftCorner<kCount, kCount>() = state_.covariance;
    covariance_.bottomLeftCorner<3, kCount>() = model.by_state * state_.covariance;
    covariance_.topRightCorner<kCount, 3>() = covariance_.bottomLeftCorner<3, kCount>().transpose();
    covariance_.bottomRightCorner<3, 3>() =
        model.by_state * state_.covariance * model.by_state.transpose() + model.noise;
    WeighInOthers();
    AddMotion();
  }

 private:
  MotionModel ChooseModel() {
    if (stretch_.wheels) {
      raw_ = record_.wheels.Between(stretch_.from_ns, stretch_.to_ns);
      return FromWheels(raw_);
    }
    MotionModel model = stretch_.imu ? FromImu() : Unknown();
    if (stretch_.vision) {
      raw_ = record_.vision.Between(stretch_.from_ns, stretch_.to_ns);
    } else {
      raw_.motion = model.motion;
      raw_.path_m = model.motion.translation().norm();
      raw_.turn_rad = std::abs(model.motion.yaw());
    }
    return model;
  }

  Eigen::Matrix3d Stillness() const {
    const OdometryNoise& o = options_.odometry;
    return dt_ *
           Eigen::Vector3d(Square(o.still_m), Square(o.still_m), Square(o.still_rad)).asDiagonal().toDenseMatrix();
  }

  // The turn is spread over the stretch: an error of it turns the way travelled by half as much.
  MotionModel FromWheels(const TrackMotion& raw) const {
    const OdometryBias& bias = state_.odometry_bias;
    const OdometryNoise& o = options_.odometry;
    const double turn = bias.yaw_scale * raw.motion.yaw() + bias.drift_rad_per_m * raw.path_m;
    const Eigen::Matrix2d half_turn = Pose2(0.0, 0.0, 0.5 * turn).rotation();
    const Eigen::Vector2d way = (1.0 + bias.scale) * (half_turn * raw.motion.translation());
    MotionModel model;
    model.motion = Pose2(way.x(), way.y(), raw.motion.yaw() + turn);
    const Eigen::Matrix2d to_end = model.motion.rotation().transpose();
    Eigen::Vector3d by_turn;
    by_turn << 0.5 * (to_end * QuarterTurn(way)), 1.0;
    model.by_state.block<2, 1>(0, kOdometryScale) = to_end * (half_turn * raw.motion.translation());
    model.by_state.col(kOdometryYawScale) = raw.motion.yaw() * by_turn;
    model.by_state.col(kOdometryDrift) = raw.path_m * by_turn;
    const double factor = state_.wheel_noise_factor;
    const double turn_variance =
        factor * (Square(o.noise_rad) * raw.path_m + Square(o.noise_rad_per_rad) * raw.turn_rad);
    model.noise = turn_variance * by_turn * by_turn.transpose() + Stillness();
    model.noise.topLeftCorner<2, 2>() += factor * Square(o.noise_m) * raw.path_m * Eigen::Matrix2d::Identity();
    return model;
  }

  double GyroVariance(double yaw) const {
    return Square(options_.imu.gyro) * dt_ + Square(options_.imu.gyro_scale * yaw);
  }

  // x, y of the base at the end in the base at the beginning.
  Eigen::Vector2d ImuWay() const { return dt_ * state_.velocity_m_s + imu_.position_m; }
  double ImuWayVariance() const { return Square(options_.imu.accelerometer) * dt_ * dt_ * dt_ / 3.0; }

  MotionModel FromImu() const {
    const Eigen::Vector2d way = ImuWay();
    MotionModel model;
    model.motion = Pose2(way.x(), way.y(), imu_.yaw_rad);
    const Eigen::Matrix2d to_end = model.motion.rotation().transpose();
    model.by_state.block<2, 2>(0, kVelocity) = dt_ * to_end;
    model.by_state.block<2, 2>(0, kAccelerationBias) = to_end * imu_.position_by_bias;
    model.by_state(2, kGyroBias) = -dt_;
    model.noise.diagonal() << ImuWayVariance(), ImuWayVariance(), GyroVariance(imu_.yaw_rad);
    model.noise += Stillness();
    return model;
  }

  // Pictures tell where to linearize; how sure they are is CorrectByVision's concern.
  MotionModel Unknown() const {
    const UnknownMotion& u = options_.unknown;
    MotionModel model;
    double way_sigma = u.speed_m_s * dt_;
    if (stretch_.vision) {
      model.motion = record_.vision.Between(stretch_.from_ns, stretch_.to_ns).motion;
    } else if (dt_ <= u.coast_s) {
      const Eigen::Vector2d way = dt_ * state_.velocity_m_s;
      model.motion = Pose2(way.x(), way.y(), 0.0);
      model.by_state.block<2, 2>(0, kVelocity) = dt_ * Eigen::Matrix2d::Identity();
      way_sigma = 0.5 * u.acceleration_m_s2 * dt_ * dt_;
    }
    model.noise.diagonal() << Square(way_sigma), Square(way_sigma), Square(u.yaw_rate_rad_s * dt_);
    model.noise += Stillness();
    return model;
  }

  void WeighInOthers() {
    if (stretch_.imu && stretch_.wheels) {
      WeighInGyro();
      WeighInAccelerations();
    }
  }

  // The gyro's turn, less its bias, is that of the motion. Where it contradicts the wheels, they slip, or the vehicle
  // was knocked: nobody knows whom to believe.
  void WeighInGyro() {
    Eigen::Matrix<double, 1, kAll> jacobian = Eigen::Matrix<double, 1, kAll>::Zero();
    jacobian(kMotion + 2) = 1.0;
    jacobian(kGyroBias) = dt_;
    const Eigen::Matrix<double, 1, 1> residual(WrapAngle(imu_.yaw_rad - motion_.yaw()));
    const Eigen::Matrix<double, 1, 1> noise(GyroVariance(imu_.yaw_rad));
    if (Contradicts<1>(residual, jacobian, noise)) {
      covariance_(kMotion + 2, kMotion + 2) += residual.squaredNorm();
    } else {
      Correct<1>(residual, jacobian, noise);
    }
  }

  // The way is what velocity and accelerations lead to.
  void WeighInAccelerations() {
    Eigen::Matrix<double, 2, kAll> jacobian = Eigen::Matrix<double, 2, kAll>::Zero();
    jacobian.block<2, 2>(0, kMotion) = motion_.rotation();
    jacobian.block<2, 2>(0, kVelocity) = -dt_ * Eigen::Matrix2d::Identity();
    jacobian.block<2, 2>(0, kAccelerationBias) = -imu_.position_by_bias;
    const Eigen::Vector2d residual = ImuWay() - motion_.translation();
    const Eigen::Matrix2d noise = ImuWayVariance() * Eigen::Matrix2d::Identity();
    if (Contradicts<2>(residual, jacobian, noise)) {
      covariance_.block<2, 2>(kMotion, kMotion) += residual.squaredNorm() * Eigen::Matrix2d::Identity();
    } else {
      Correct<2>(residual, jacobian, noise);
    }
  }

  template <int kRows>
  bool Contradicts(const Eigen::Matrix<double, kRows, 1>& residual, const Eigen::Matrix<double, kRows, kAll>& jacobian,
                   const Eigen::Matrix<double, kRows, kRows>& noise) {
    const bool contradicts =
        MahalanobisSquared<kRows, kAll>(residual, jacobian, noise, covariance_) > options_.max_slip_mahalanobis_squared;
    contradicted_ = contradicted_ || contradicts;
    return contradicts;
  }

  // Kalman's correction of state and motion.
  template <int kRows>
  void Correct(const Eigen::Matrix<double, kRows, 1>& residual, const Eigen::Matrix<double, kRows, kAll>& jacobian,
               const Eigen::Matrix<double, kRows, kRows>& noise) {
    const AllErrors error = KalmanCorrection<kRows, kAll>(residual, jacobian, noise, &covariance_);
    state_.Add(error.template head<kCount>());
    motion_ = motion_ * Pose2::Exp(error.template tail<3>());
  }

  // The pose takes the motion in, and the motion's error becomes the pose's.
  void AddMotion() {
    Eigen::Matrix<double, kCount, kAll> jacobian = Eigen::Matrix<double, kCount, kAll>::Identity();
    jacobian.block<3, 3>(kPose, kPose) = motion_.Inverse().Adjoint();
    jacobian.block<3, 3>(kPose, kMotion).setIdentity();
    ErrorVector noise = ErrorVector::Zero();
    MoveVelocity(&jacobian, &noise);
    ForgetFixBias(&jacobian, &noise);
    noise(kGyroBias) = Square(options_.imu.gyro_walk) * dt_;
    noise.segment<2>(kAccelerationBias).setConstant(Square(options_.imu.accelerometer_walk) * dt_);
    state_.covariance = jacobian * covariance_ * jacobian.transpose();
    state_.covariance.diagonal() += noise;
    state_.covariance = 0.5 * (state_.covariance + state_.covariance.transpose()).eval();
    state_.map_from_base = state_.map_from_base * motion_;
    state_.odom_from_base = state_.odom_from_base * raw_.motion;
    state_.path_m += raw_.path_m;
    state_.turn_rad += raw_.turn_rad;
    state_.stamp_ns = stretch_.to_ns;
  }

  // A Gauss-Markov process along the path.
  void ForgetFixBias(Eigen::Matrix<double, kCount, kAll>* jacobian, ErrorVector* noise) {
    const SharedFixNoise& shared = options_.shared_fix;
    const double kept = std::exp(-raw_.path_m / shared.correlation_m);
    state_.fix_bias *= kept;
    jacobian->middleRows<3>(kFixBias) *= kept;
    noise->segment<3>(kFixBias) = (1.0 - kept * kept) * FixBiasVariance(shared);
  }

  // With an IMU the velocity goes on from what it was; without, it is the mean velocity of the stretch, give or take
  // what a vehicle accelerates in half of it.
  void MoveVelocity(Eigen::Matrix<double, kCount, kAll>* jacobian, ErrorVector* noise) {
    const Eigen::Matrix2d to_end = motion_.rotation().transpose();
    jacobian->middleRows<2>(kVelocity).setZero();
    if (stretch_.imu && !contradicted_) {
      state_.velocity_m_s = to_end * (state_.velocity_m_s + imu_.velocity_m_s);
      jacobian->block<2, 2>(kVelocity, kVelocity) = to_end;
      jacobian->block<2, 2>(kVelocity, kAccelerationBias) = to_end * imu_.velocity_by_bias;
      jacobian->block<2, 1>(kVelocity, kMotion + 2) = -QuarterTurn(state_.velocity_m_s);
      noise->segment<2>(kVelocity).setConstant(Square(options_.imu.accelerometer) * dt_);
    } else if (stretch_.wheels || stretch_.vision) {
      state_.velocity_m_s = to_end * motion_.translation() / dt_;
      jacobian->block<2, 2>(kVelocity, kMotion) = Eigen::Matrix2d::Identity() / dt_;
      jacobian->block<2, 1>(kVelocity, kMotion + 2) = -QuarterTurn(state_.velocity_m_s);
      noise->segment<2>(kVelocity).setConstant(Square(0.5 * options_.unknown.acceleration_m_s2 * dt_));
    } else if (dt_ <= options_.unknown.coast_s) {
      jacobian->block<2, 2>(kVelocity, kVelocity).setIdentity();
      noise->segment<2>(kVelocity).setConstant(Square(options_.unknown.acceleration_m_s2 * dt_));
    } else {
      state_.velocity_m_s.setZero();
      noise->segment<2>(kVelocity).setConstant(Square(options_.unknown.speed_m_s));
    }
  }

  const MotionRecord& record_;
  const PoseFilterOptions& options_;
  const Stretch stretch_;
  const double dt_;
  FilterState& state_;
  ImuMotion imu_;
  TrackMotion raw_;            // as measured, for the odom frame
  Pose2 motion_;               // as estimated
  bool contradicted_ = false;  // wheels and IMU do not go together: slip, or a knock
  AllCovariance covariance_ = AllCovariance::Zero();
};

// The longest stretch from a time on in which the same sources tell the motion.
Stretch NextStretch(const MotionRecord& record, std::int64_t from_ns, std::int64_t to_ns) {
  Stretch stretch{from_ns, to_ns, false, false, false};
  const auto take = [&](const auto& track, bool* covers) {
    const std::int64_t until = track.CoveredUntil(from_ns, to_ns);
    *covers = until > from_ns;
    const std::int64_t change = *covers ? until : std::max(from_ns, track.NextStart(from_ns, to_ns));
    if (change > from_ns) {
      stretch.to_ns = std::min(stretch.to_ns, change);
    }
  };
  take(record.wheels, &stretch.wheels);
  take(record.vision, &stretch.vision);
  take(record.imu, &stretch.imu);
  return stretch;
}

}  // namespace

void CarryOn(const MotionRecord& record, const PoseFilterOptions& options, std::int64_t to_ns, FilterState* state) {
  while (state->stamp_ns < to_ns) {
    Step(record, options, NextStretch(record, state->stamp_ns, to_ns), state).Run();
  }
}

}  // namespace floorloc
