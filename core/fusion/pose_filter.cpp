// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/pose_filter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/fusion/fix_gate.h"
#include "core/fusion/sensor_reset.h"
#include "core/fusion/visual_correction.h"

namespace floorloc {
namespace {

// Interval of the remembered states, which bounds the recomputation after a late message.
constexpr std::int64_t kCheckpointNs = 200'000'000;

// The motion while the clock was set is unknown.
constexpr double kClockJumpSigmaM = 0.3;
constexpr double kClockJumpSigmaRad = 0.3;

std::int64_t ToNs(double seconds) { return static_cast<std::int64_t>(std::llround(1e9 * seconds)); }

double Square(double x) { return x * x; }

const PoseFilterOptions& Checked(const PoseFilterOptions& options) {
  options.Check();
  return options;
}

}  // namespace

PoseFilter::PoseFilter(const PoseFilterOptions& options)
    : options_(Checked(options)), kidnap_(options.kidnap), monitor_(options.monitor), doubt_(options.monitor) {}

bool PoseFilter::IsBeforeHistory(std::int64_t stamp_ns) const {
  return newest_ns_ && stamp_ns < *newest_ns_ - ToNs(options_.history_s);
}

void PoseFilter::Advance(std::int64_t stamp_ns) {
  messages_before_history_ = 0;
  newest_ns_ = std::max(newest_ns_.value_or(stamp_ns), stamp_ns);
  if (!checkpoints_.empty() && *newest_ns_ - checkpoints_.back().state.stamp_ns >= 2 * kCheckpointNs) {
    checkpoints_.push_back({StateAt(*newest_ns_ - kCheckpointNs)});
  }
  TrimHistory();
}

void PoseFilter::TrimHistory() {
  const std::int64_t horizon_ns = *newest_ns_ - ToNs(options_.history_s);
  while (checkpoints_.size() > 1 && checkpoints_[1].state.stamp_ns <= horizon_ns) {
    checkpoints_.pop_front();
  }
  const std::int64_t needed_ns =
      checkpoints_.empty() ? horizon_ns : std::min(horizon_ns, checkpoints_.front().state.stamp_ns);
  const auto trim = [&](auto* track) {
    track->DropBefore(needed_ns);
    while (track->size() > options_.max_messages) {
      track->DropOldest();
    }
  };
  trim(&record_.wheels);
  trim(&record_.vision);
  trim(&record_.imu);
}

// Messages before the first pose are kept too: they move odom_from_base.
void PoseFilter::Start(std::int64_t stamp_ns) {
  if (checkpoints_.empty()) {
    checkpoints_.push_back({InitialState(stamp_ns, options_)});
  }
}

// Clock jump of the sender: keeps the estimate, restamped, and drops the history.
void PoseFilter::RestartAt(std::int64_t stamp_ns) {
  FilterState state = StateAt(*newest_ns_);
  record_.Clear();
  checkpoints_.clear();
  kidnap_.Clear();
  monitor_.Clear();
  doubt_.Settle(std::nullopt);
  last_fix_ns_.reset();
  last_frame_agreed_ = false;
  newest_ns_ = stamp_ns;
  state.stamp_ns = stamp_ns;
  state.velocity_m_s.setZero();
  state.covariance.diagonal().head<3>() +=
      Eigen::Vector3d(Square(kClockJumpSigmaM), Square(kClockJumpSigmaM), Square(kClockJumpSigmaRad));
  checkpoints_.push_back({state});
}

template <typename Track, typename Message>
MessageOutcome PoseFilter::AddTo(Track* track, const Message& message, std::int64_t begin_ns, std::int64_t end_ns) {
  if (IsBeforeHistory(end_ns)) {
    if (++messages_before_history_ < options_.clock_jump_messages) {
      return MessageOutcome::kTooOld;
    }
    RestartAt(begin_ns);
    track->Add(message);
    Advance(end_ns);
    return MessageOutcome::kClockJump;
  }
  const bool past = newest_ns_ && begin_ns < *newest_ns_;
  const MessageOutcome outcome = track->Add(message);
  if (outcome == MessageOutcome::kUsed || outcome == MessageOutcome::kUsedLate) {
    Start(begin_ns);
    if (past) {
      RepropagateSince(begin_ns);
    }
    Advance(end_ns);
  }
  return outcome;
}

MessageOutcome PoseFilter::AddIncrement(MotionSource source, const MotionIncrement& increment) {
  const bool wheels = source == MotionSource::kWheels;
  const MotionIncrement placed = wheels ? WithRightStamp(increment) : increment;
  const MessageOutcome outcome =
      AddTo(wheels ? &record_.wheels : &record_.vision, placed, placed.from_ns, placed.to_ns);
  const bool used = outcome == MessageOutcome::kUsed || outcome == MessageOutcome::kUsedLate;
  if (wheels && (used || outcome == MessageOutcome::kClockJump)) {
    monitor_.AddWheels(increment);
  } else if (used) {
    AddVision(increment);
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

// Corrects the state at the image's time and repropagates the states after it.
void PoseFilter::AddVision(const MotionIncrement& increment) {
  if (increment.to_ns < checkpoints_.front().state.stamp_ns) {
    return;
  }
  const std::size_t index = CheckpointAt(increment.to_ns);
  checkpoints_[index].vision = increment;
  RepropagateFrom(index);
}

MessageOutcome PoseFilter::AddImu(const ImuReading& reading) {
  const std::int64_t begin_ns = record_.imu.empty() ? reading.stamp_ns : record_.imu.newest_ns();
  return AddTo(&record_.imu, reading, std::min(begin_ns, reading.stamp_ns), reading.stamp_ns);
}

std::size_t PoseFilter::LastCheckpointBefore(std::int64_t stamp_ns) const {
  const auto after = std::upper_bound(checkpoints_.begin(), checkpoints_.end(), stamp_ns,
                                      [](std::int64_t stamp, const Checkpoint& c) { return stamp < c.state.stamp_ns; });
  return static_cast<std::size_t>(after - checkpoints_.begin()) - 1;  // the first one is never later than stamp_ns
}

FilterState PoseFilter::StateAt(std::int64_t stamp_ns) const {
  FilterState state = checkpoints_[LastCheckpointBefore(stamp_ns)].state;
  Propagate(record_, options_, stamp_ns, &state);
  return state;
}

// Index of the checkpoint at a time; inserts one when there is none.
std::size_t PoseFilter::CheckpointAt(std::int64_t stamp_ns) {
  const std::size_t before = LastCheckpointBefore(stamp_ns);
  if (checkpoints_[before].state.stamp_ns == stamp_ns) {
    return before;
  }
  checkpoints_.insert(checkpoints_.begin() + static_cast<std::ptrdiff_t>(before + 1), {StateAt(stamp_ns)});
  return before + 1;
}

// Fixes that were accepted stay accepted.
void PoseFilter::RepropagateSince(std::int64_t stamp_ns) {
  if (!checkpoints_.empty() && checkpoints_.back().state.stamp_ns > stamp_ns) {
    RepropagateFrom(stamp_ns < checkpoints_.front().state.stamp_ns ? 0 : LastCheckpointBefore(stamp_ns) + 1);
  }
}

// The first state has no predecessor to be predicted from and is kept.
void PoseFilter::RepropagateFrom(std::size_t index) {
  for (std::size_t i = std::max<std::size_t>(index, 1); i < checkpoints_.size(); ++i) {
    const std::int64_t stamp = checkpoints_[i].state.stamp_ns;
    checkpoints_[i].state = checkpoints_[i - 1].state;
    Propagate(record_, options_, stamp, &checkpoints_[i].state);
    Apply(&checkpoints_[i]);
  }
}

// Applies the measurements of the checkpoint's time to the predicted state.
void PoseFilter::Apply(Checkpoint* checkpoint) const {
  FilterState* state = &checkpoint->state;
  if (checkpoint->fix) {
    AdaptWheelNoise(*checkpoint->fix, options_.adaptation, state);
  }
  if (checkpoint->vision) {
    CorrectByVision(*checkpoint->vision, options_, state);
  }
  if (checkpoint->fix && checkpoint->fix_accepted) {
    CorrectByFix(*checkpoint->fix, state);
    state->path_m = state->turn_rad = 0.0;
  }
}

FixOutcome PoseFilter::AddFix(const PoseFix& fix) {
  FixOutcome outcome;
  if (!IsValid(fix)) {
    outcome.reason = FixRejection::kInvalid;
    return outcome;
  }
  Start(fix.stamp_ns);
  if (IsBeforeHistory(fix.stamp_ns) || fix.stamp_ns < checkpoints_.front().state.stamp_ns) {
    outcome.reason = FixRejection::kTooOld;
    return outcome;
  }
  const std::optional<PoseFix>& last = checkpoints_[LastCheckpointBefore(fix.stamp_ns)].fix;
  if (last && last->stamp_ns == fix.stamp_ns) {
    outcome.reason = FixRejection::kDuplicate;
    return outcome;
  }
  const bool rejects_wheels = fix.p_wrong <= options_.gates.max_p_wrong && JudgeOdometry(fix);
  const FilterState predicted = StateAt(fix.stamp_ns);
  outcome = GateFix(fix, predicted, options_.gates);
  Advance(fix.stamp_ns);
  doubt_.Note(fix, outcome);
  if (rejects_wheels && has_pose_) {
    return AnchorWithFreshSensors(fix, checkpoints_.front().state);  // from before the fault, if the history is
  }
  if (outcome.reason != FixRejection::kWrongFixRisk && (!has_pose_ || IsLost(predicted))) {
    return Anchor(fix);
  }
  if (outcome.accepted || outcome.reason == FixRejection::kMahalanobis) {
    Insert(fix, outcome);
  }
  return outcome.accepted ? Accept(fix, outcome) : Reject(fix, outcome);
}

// Returns true when the wheels are rejected from this fix on.
bool PoseFilter::JudgeOdometry(const PoseFix& fix) {
  if (!options_.monitor.enabled) {
    return false;
  }
  const bool trusted = monitor_.Trusted();
  const std::int64_t offset_ns = monitor_.offset_ns();
  monitor_.AddFix(fix);
  if (monitor_.offset_ns() != offset_ns) {
    record_.wheels.Shift(offset_ns - monitor_.offset_ns());
    RepropagateFrom(0);
  }
  record_.trust_wheels = record_.trust_wheels && monitor_.Trusted();  // trusted again when the pose is right
  return trusted && !monitor_.Trusted();
}

// Inserts a fix at its time and repropagates the states after it.
void PoseFilter::Insert(const PoseFix& fix, const FixOutcome& outcome) {
  const std::size_t index = CheckpointAt(fix.stamp_ns);
  checkpoints_[index].fix = fix;
  checkpoints_[index].fix_accepted = outcome.accepted;
  if (index == 0 && outcome.accepted) {
    CorrectByFix(fix, &checkpoints_[0].state);
  }
  RepropagateFrom(index);
}

FixOutcome PoseFilter::Accept(const PoseFix& fix, const FixOutcome& outcome) {
  kidnap_.Clear();
  record_.trust_wheels = monitor_.Trusted();
  last_fix_ns_ = std::max(last_fix_ns_.value_or(fix.stamp_ns), fix.stamp_ns);
  last_frame_agreed_ = true;
  return outcome;
}

FixOutcome PoseFilter::Reject(const PoseFix& fix, FixOutcome outcome) {
  last_frame_agreed_ = false;
  if (outcome.reason == FixRejection::kWrongFixRisk) {
    return outcome;
  }
  const FilterState& sensors = checkpoints_.back().state;
  const auto motion = [&](std::int64_t from_ns, std::int64_t to_ns) {
    FilterState moved = sensors;
    moved.stamp_ns = from_ns;
    ResetPose(Pose2(), Eigen::Matrix3d::Zero(), &moved);
    Propagate(record_, options_, to_ns, &moved);
    return MotionEstimate{moved.map_from_base, LargestSigma(moved.covariance.topLeftCorner<2, 2>()),
                          std::sqrt(moved.covariance(2, 2))};
  };
  const KidnapOptions& kidnap = options_.kidnap;
  const bool near = outcome.reason == FixRejection::kMahalanobis;
  const bool suspect = options_.monitor.enabled && doubt_.IsSuspect() && doubt_.Previous();
  const FilterState learnt = doubt_.IsRestless() || suspect ? InitialState(fix.stamp_ns, options_) : sensors;
  if (kidnap_.AddContradiction(fix, motion) >= (near ? kidnap.near_fixes : kidnap.fixes)) {
    return options_.monitor.enabled && doubt_.IsRestless() ? AnchorWithFreshSensors(fix, learnt) : Anchor(fix);
  }
  // Without wheels the prediction is a guess: a fix that the vehicle can have reached is better.
  const bool reached = !record_.trust_wheels && doubt_.IsReachable();
  return (suspect && near) || reached ? AnchorWithFreshSensors(fix, learnt) : outcome;
}

// Resets the pose to the fix where motion sensors contradict the fixes: the velocity is that of the fixes, the biases
// of the IMU are those of `imu`, and the wheels' noise is what the contradiction shows.
FixOutcome PoseFilter::AnchorWithFreshSensors(const PoseFix& fix, const FilterState& imu) {
  // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): it may be of the history, which is dropped below
  const FilterState imu_state = imu;
  const FilterState initial = InitialState(fix.stamp_ns, options_);
  const FilterState predicted = StateAt(fix.stamp_ns);
  const double off_m = predicted.map_from_base.Between(fix.map_from_base).translation().norm();
  const std::optional<PoseFix> previous = doubt_.Previous();
  const FixOutcome outcome = Anchor(fix);
  FilterState* state = &checkpoints_.front().state;
  ForgetSensors(initial, imu_state, record_.trust_wheels ? predicted : initial, state);
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
  FilterState state = StateAt(fix.stamp_ns);
  ResetToFix(fix, options_.shared_fix, &state);
  state.path_m = state.turn_rad = 0.0;
  checkpoints_.clear();
  checkpoints_.push_back({state, {}, fix, true});
  kidnap_.Clear();
  record_.trust_wheels = monitor_.Trusted();
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
  Start(pose.stamp_ns);
  FilterState state = StateAt(std::max(pose.stamp_ns, checkpoints_.front().state.stamp_ns));
  if (IsBeforeHistory(pose.stamp_ns)) {
    record_.Clear();
    monitor_.Clear();
    newest_ns_ = pose.stamp_ns;
  }
  state.stamp_ns = pose.stamp_ns;
  state.path_m = state.turn_rad = 0.0;
  ResetPose(pose.map_from_base, ToBaseFrame(pose.covariance, pose.map_from_base), &state);
  checkpoints_.clear();
  checkpoints_.push_back({state});
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
  return StateAt(*newest_ns_);
}

std::optional<FusedPose> PoseFilter::Estimate() const {
  const std::optional<FilterState> state = State();
  return state ? std::optional(ToFusedPose(*state)) : std::nullopt;
}

std::optional<FusedPose> PoseFilter::EstimateAt(std::int64_t stamp_ns) const {
  if (!has_pose_ || stamp_ns < checkpoints_.front().state.stamp_ns) {
    return std::nullopt;
  }
  return ToFusedPose(StateAt(stamp_ns));
}

std::optional<Pose2> PoseFilter::MotionBetween(std::int64_t from_ns, std::int64_t to_ns) const {
  if (checkpoints_.empty() || from_ns < checkpoints_.front().state.stamp_ns || to_ns < from_ns) {
    return std::nullopt;
  }
  FilterState state = StateAt(from_ns);
  const Pose2 map_from_start = state.map_from_base;
  Propagate(record_, options_, to_ns, &state);
  return map_from_start.Between(state.map_from_base);
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
  if (!record_.wheels.empty()) {
    pose.odometry = TrustIn(state);
  }
  if (last_fix_ns_) {
    pose.since_fix = {1e-9 * static_cast<double>(state.stamp_ns - *last_fix_ns_), state.path_m, state.turn_rad};
  }
  return pose;
}

}  // namespace floorloc
