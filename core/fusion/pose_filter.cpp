// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/pose_filter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/fusion/fix_gate.h"
#include "core/fusion/sensor_reset.h"

namespace floorloc {
namespace {

const PoseFilterOptions& Checked(const PoseFilterOptions& options) {
  options.Check();
  return options;
}

}  // namespace

PoseFilter::PoseFilter(const PoseFilterOptions& options)
    : options_(Checked(options)),
      history_(options),
      kidnap_(options.kidnap),
      monitor_(options.monitor),
      gyro_monitor_(options.gyro_monitor),
      doubt_(options.monitor) {}

// Before there is more to tell, what was resumed.
std::optional<LearntOdometry> PoseFilter::Learnt() const {
  if (!has_pose_ || monitor_.Trust().health == OdometryHealth::kLearning) {
    return history_.resumed();
  }
  if (!monitor_.Trusted()) {
    return std::nullopt;
  }
  LearntOdometry learnt = LearntIn(history_.newest());
  learnt.offset_ns = monitor_.offset_ns();
  return learnt;
}

void PoseFilter::Resume(const LearntOdometry& learnt) {
  history_.Resume(learnt);
  monitor_.ResumeOffset(learnt.offset_ns);
}

// Clock jump of the sender: keeps the estimate, restamped, and drops the history.
void PoseFilter::RestartAt(std::int64_t stamp_ns) {
  FilterState state = history_.StateAt(*history_.newest_ns());
  history_.ForgetMeasurements(stamp_ns);
  kidnap_.Clear();
  monitor_.Clear();
  gyro_monitor_.Clear();
  doubt_.Settle(std::nullopt);
  last_fix_ns_.reset();
  last_frame_agreed_ = false;
  state.stamp_ns = stamp_ns;
  state.velocity_m_s.setZero();
  const Eigen::Vector3d sigma(options_.clock_jump_sigma_m, options_.clock_jump_sigma_m, options_.clock_jump_sigma_rad);
  state.covariance.diagonal().head<3>() += sigma.cwiseAbs2();
  history_.Reset(state);
}

template <typename Track, typename Message>
MessageOutcome PoseFilter::AddTo(Track* track, const Message& message, std::int64_t begin_ns, std::int64_t end_ns) {
  if (history_.IsTooOld(end_ns)) {
    if (++messages_before_history_ < options_.clock_jump_messages) {
      return MessageOutcome::kTooOld;
    }
    RestartAt(begin_ns);
    track->Add(message);
    Advance(end_ns);
    return MessageOutcome::kClockJump;
  }
  const bool past = begin_ns < history_.newest_ns().value_or(begin_ns);
  const MessageOutcome outcome = track->Add(message);
  if (outcome == MessageOutcome::kUsed || outcome == MessageOutcome::kUsedLate) {
    history_.Start(begin_ns);
    if (past) {
      history_.RepropagateSince(begin_ns);
    }
    Advance(end_ns);
  }
  return outcome;
}

void PoseFilter::Advance(std::int64_t stamp_ns) {
  messages_before_history_ = 0;
  history_.Advance(stamp_ns);
}

MessageOutcome PoseFilter::AddIncrement(MotionSource source, const MotionIncrement& increment) {
  const bool wheels = source == MotionSource::kWheels;
  const MotionIncrement placed = wheels ? WithRightStamp(increment) : increment;
  const MessageOutcome outcome =
      AddTo(wheels ? &history_.record().wheels : &history_.record().vision, placed, placed.from_ns, placed.to_ns);
  const bool used = outcome == MessageOutcome::kUsed || outcome == MessageOutcome::kUsedLate;
  if (wheels && (used || outcome == MessageOutcome::kClockJump)) {
    monitor_.AddWheels(increment);
  } else if (used) {
    history_.AddVision(increment);
  }
  return outcome;
}

// The wheels' stamp by the clock of the images.
MotionIncrement PoseFilter::WithRightStamp(const MotionIncrement& increment) const {
  MotionIncrement placed = increment;
  placed.from_ns -= monitor_.offset_ns();
  placed.to_ns -= monitor_.offset_ns();
  return placed;
}

MessageOutcome PoseFilter::AddImu(const ImuReading& reading) {
  ImuTrack* imu = &history_.record().imu;
  const std::int64_t begin_ns = imu->empty() ? reading.stamp_ns : imu->newest_ns();
  return AddTo(imu, reading, std::min(begin_ns, reading.stamp_ns), reading.stamp_ns);
}

FixOutcome PoseFilter::AddFix(const PoseFix& fix) {
  FixOutcome outcome;
  if (!IsValid(fix)) {
    outcome.reason = FixRejection::kInvalid;
    return outcome;
  }
  history_.Start(fix.stamp_ns);
  if (history_.IsTooOld(fix.stamp_ns) || fix.stamp_ns < history_.oldest().stamp_ns) {
    outcome.reason = FixRejection::kTooOld;
    return outcome;
  }
  if (history_.HasFixAt(fix.stamp_ns)) {
    outcome.reason = FixRejection::kDuplicate;
    return outcome;
  }
  const bool rejects_wheels = fix.p_wrong <= options_.gates.max_p_wrong && JudgeOdometry(fix);
  FilterState predicted = history_.StateAt(fix.stamp_ns);
  outcome = GateFix(fix, predicted, options_.gates);
  if (!outcome.accepted && outcome.reason != FixRejection::kWrongFixRisk) {
    OutvoteVision(fix, &predicted, &outcome);
  }
  Advance(fix.stamp_ns);
  doubt_.Note(fix, outcome);
  if (rejects_wheels && has_pose_) {
    return AnchorWithFreshSensors(fix, history_.oldest());  // from before the fault, if the history is
  }
  if (outcome.reason != FixRejection::kWrongFixRisk && (!has_pose_ || IsLost(predicted))) {
    return Anchor(fix);
  }
  if (outcome.accepted || outcome.reason == FixRejection::kMahalanobis) {
    history_.AddFix(fix, outcome.accepted);
  }
  return outcome.accepted ? Accept(fix, outcome) : Reject(fix, outcome);
}

// Returns true when the wheels are rejected from this fix on.
bool PoseFilter::JudgeOdometry(const PoseFix& fix) {
  if (!options_.monitor.enabled) {
    return false;
  }
  JudgeGyro(fix);
  const bool trusted = monitor_.Trusted();
  const std::int64_t offset_ns = monitor_.offset_ns();
  monitor_.AddFix(fix);
  if (monitor_.offset_ns() != offset_ns) {
    history_.record().wheels.Shift(offset_ns - monitor_.offset_ns());
    history_.RepropagateAll();
  }
  bool* trust_wheels = &history_.record().trust_wheels;
  *trust_wheels = *trust_wheels && monitor_.Trusted();  // trusted again when the pose is right
  return trusted && !monitor_.Trusted();
}

// Where fix and wheels agree, but for the motions between images since the last fix, those are wrong: on a texture that
// recurs, images that have little in common may be registered with each other elsewhere.
void PoseFilter::OutvoteVision(const PoseFix& fix, FilterState* predicted, FixOutcome* outcome) {
  if (!last_fix_ns_ || *last_fix_ns_ >= fix.stamp_ns || !history_.record().trust_wheels ||
      history_.record().wheels.empty()) {
    return;
  }
  const std::optional<FilterState> by_wheels = history_.StateWithoutVision(*last_fix_ns_, fix.stamp_ns);
  if (!by_wheels) {
    return;
  }
  const FixOutcome agreed = GateFix(fix, *by_wheels, options_.gates);
  if (agreed.accepted) {
    history_.DropVision(*last_fix_ns_);
    *predicted = *by_wheels;
    *outcome = agreed;
  }
}

void PoseFilter::JudgeGyro(const PoseFix& fix) {
  MotionRecord& record = history_.record();
  gyro_monitor_.AddFix(fix, record.imu);
  if (record.trust_imu != gyro_monitor_.Trusted()) {
    record.trust_imu = gyro_monitor_.Trusted();
    history_.RepropagateAll();
  }
}

FixOutcome PoseFilter::Accept(const PoseFix& fix, const FixOutcome& outcome) {
  kidnap_.Clear();
  history_.record().trust_wheels = monitor_.Trusted();
  last_fix_ns_ = std::max(last_fix_ns_.value_or(fix.stamp_ns), fix.stamp_ns);
  last_frame_agreed_ = true;
  return outcome;
}

FixOutcome PoseFilter::Reject(const PoseFix& fix, FixOutcome outcome) {
  last_frame_agreed_ = false;
  if (outcome.reason == FixRejection::kWrongFixRisk) {
    return outcome;
  }
  const auto motion = [this](std::int64_t from_ns, std::int64_t to_ns) {
    return history_.MotionByNewest(from_ns, to_ns);
  };
  const KidnapOptions& kidnap = options_.kidnap;
  const bool near = outcome.reason == FixRejection::kMahalanobis;
  const bool suspect = options_.monitor.enabled && doubt_.IsSuspect() && doubt_.Previous();
  const FilterState learnt = doubt_.IsRestless() || suspect ? InitialState(fix.stamp_ns, options_) : history_.newest();
  if (kidnap_.AddContradiction(fix, motion) >= (near ? kidnap.near_fixes : kidnap.fixes)) {
    return options_.monitor.enabled && doubt_.IsRestless() ? AnchorWithFreshSensors(fix, learnt) : Anchor(fix);
  }
  // Without wheels the prediction is a guess: a fix that the vehicle can have reached is better.
  const bool reached = !history_.record().trust_wheels && doubt_.IsReachable();
  return (suspect && near) || reached ? AnchorWithFreshSensors(fix, learnt) : outcome;
}

// Resets the pose to the fix where motion sensors contradict the fixes: the velocity is that of the fixes, the biases
// of the IMU are those of `imu`, and the wheels' noise is what the contradiction shows.
FixOutcome PoseFilter::AnchorWithFreshSensors(const PoseFix& fix, const FilterState& imu) {
  // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): it may be of the history, which is dropped below
  const FilterState imu_state = imu;
  const FilterState initial = InitialState(fix.stamp_ns, options_);
  const FilterState predicted = history_.StateAt(fix.stamp_ns);
  const double off_m = predicted.map_from_base.Between(fix.map_from_base).translation().norm();
  const std::optional<PoseFix> previous = doubt_.Previous();
  const FixOutcome outcome = Anchor(fix);
  FilterState* state = &history_.oldest();
  ForgetSensors(initial, imu_state, history_.record().trust_wheels ? predicted : initial, state);
  if (previous) {
    SetVelocity(*previous, fix, options_.motion_prior, state);
  }
  state->wheel_noise_factor = RaisedNoiseFactor(*state, off_m, predicted.path_m, options_);
  return outcome;
}

// Resets the pose to the fix; sensor biases are kept.
FixOutcome PoseFilter::Anchor(const PoseFix& fix) {
  FixOutcome outcome;
  outcome.accepted = true;
  outcome.first = !has_pose_;
  outcome.reanchored = has_pose_;
  FilterState state = history_.StateAt(fix.stamp_ns);
  ResetToFix(fix, options_.shared_fix, &state);
  state.path_m = state.turn_rad = 0.0;
  history_.Reset(state, fix);
  kidnap_.Clear();
  history_.record().trust_wheels = monitor_.Trusted();
  doubt_.Settle(fix);
  has_pose_ = true;
  last_fix_ns_ = fix.stamp_ns;
  last_frame_agreed_ = true;
  return outcome;
}

void PoseFilter::AddUnlocalizedFrame(std::int64_t stamp_ns) {
  if (!last_fix_ns_ || stamp_ns > *last_fix_ns_) {
    last_frame_agreed_ = false;
  }
}

void PoseFilter::SetPose(const PoseFix& pose) {
  history_.Start(pose.stamp_ns);
  FilterState state = history_.StateAt(std::max(pose.stamp_ns, history_.oldest().stamp_ns));
  if (history_.IsTooOld(pose.stamp_ns)) {
    history_.ForgetMeasurements(pose.stamp_ns);
    monitor_.Clear();
    gyro_monitor_.Clear();
  }
  state.stamp_ns = pose.stamp_ns;
  state.path_m = state.turn_rad = 0.0;
  ResetPose(pose.map_from_base, ToBaseFrame(pose.covariance, pose.map_from_base), &state);
  history_.Reset(state);
  kidnap_.Clear();
  doubt_.Settle(std::nullopt);
  has_pose_ = true;
  last_fix_ns_.reset();
  last_frame_agreed_ = false;
  Advance(pose.stamp_ns);
}

std::optional<FilterState> PoseFilter::State() const {
  if (!has_pose_) {
    return std::nullopt;
  }
  return history_.StateAt(*history_.newest_ns());
}

std::optional<FusedPose> PoseFilter::Estimate() const {
  const std::optional<FilterState> state = State();
  return state ? std::optional(ToFusedPose(*state)) : std::nullopt;
}

std::optional<FusedPose> PoseFilter::EstimateAt(std::int64_t stamp_ns) const {
  if (!has_pose_ || stamp_ns < history_.oldest().stamp_ns) {
    return std::nullopt;
  }
  return ToFusedPose(history_.StateAt(stamp_ns));
}

bool PoseFilter::IsLost(const FilterState& state) const {
  return LargestSigma(state.covariance.topLeftCorner<2, 2>()) > options_.limits.lost_m ||
         std::sqrt(state.covariance(2, 2)) > options_.limits.lost_rad;
}

OdometryTrust PoseFilter::TrustIn(const FilterState& state) const {
  OdometryTrust trust = monitor_.Trust();
  if (trust.health != OdometryHealth::kRejected) {
    trust.scale = 1.0 + state.odometry_bias.scale;
    trust.yaw_scale = 1.0 + state.odometry_bias.yaw_scale;
    trust.health = doubt_.IsSuspect() || doubt_.rejected_in_a_row() > 0 ? OdometryHealth::kSuspect : trust.health;
  }
  return trust;
}

FusedPose PoseFilter::ToFusedPose(const FilterState& state) const {
  FusedPose pose;
  pose.stamp_ns = state.stamp_ns;
  pose.map_from_base = state.map_from_base;
  const Eigen::Matrix3d doubt =
      options_.monitor.enabled ? doubt_.CovarianceAt(state.stamp_ns) : Eigen::Matrix3d::Zero();
  pose.covariance = state.MapCovariance() + doubt;
  pose.odom_from_base = state.odom_from_base;
  pose.map_from_odom = state.map_from_base * state.odom_from_base.Inverse();
  pose.wheel_noise_factor = state.wheel_noise_factor;
  const FilterLimits& limits = options_.limits;
  const bool fine = LargestSigma(pose.covariance.topLeftCorner<2, 2>()) <= limits.localized_m &&
                    std::sqrt(pose.covariance(2, 2)) <= limits.localized_rad;
  pose.contradicted = kidnap_.HasContradictions();
  const bool refuted = options_.monitor.enabled && doubt_.rejected_in_a_row() >= options_.kidnap.fixes;
  if (IsLost(state) || kidnap_.HasConsistentContradictions() || refuted) {
    pose.state = TrackingState::kLost;
  } else {
    pose.state = last_frame_agreed_ && fine ? TrackingState::kLocalized : TrackingState::kTrackingOdometry;
  }
  if (!history_.record().wheels.empty()) {
    pose.odometry = TrustIn(state);
  }
  if (last_fix_ns_) {
    pose.since_fix = {1e-9 * static_cast<double>(state.stamp_ns - *last_fix_ns_), state.path_m, state.turn_rad};
  }
  return pose;
}

}  // namespace floorloc
