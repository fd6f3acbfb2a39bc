// SPDX-License-Identifier: Apache-2.0
#include "server/serving/vehicle_session.h"

#include <cmath>

namespace floorloc {
namespace {

// So long an increment is taken to have lasted when no earlier message of the vehicle is known.
constexpr std::int64_t kUnknownIntervalNs = 100'000'000;

std::int64_t WindowNs(const TrackerOptions& options) {
  return static_cast<std::int64_t>(std::llround(1e9 * options.filter.history_s));
}

std::int64_t UnixNowNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

bool IsUsed(MessageOutcome message) {
  return message == MessageOutcome::kUsed || message == MessageOutcome::kUsedLate ||
         message == MessageOutcome::kClockJump;
}

}  // namespace

VehicleSession::VehicleSession(const TrackerOptions& options, double resolution_m, double timeout_s)
    : options_(options),
      resolution_m_(resolution_m),
      timeout_s_(timeout_s),
      last_heard_(Clock::now().time_since_epoch().count()),
      tracker_(options, resolution_m),
      stamps_(WindowNs(options)),
      told_(WindowNs(options)),
      frames_(WindowNs(options)) {}

double VehicleSession::SilentSeconds() const {
  const Clock::duration last_heard(last_heard_.load());
  return std::chrono::duration<double>(Clock::now().time_since_epoch() - last_heard).count();
}

void VehicleSession::ForgetStampsLocked() {
  stamps_.Clear();
  told_.Clear();
  frames_.Clear();
  last_received_ns_.reset();
  pose_set_ns_.reset();
  undated_pose_.reset();
  frames_before_history_ = 0;
  ++epoch_;
}

void VehicleSession::BeginAnewLocked() {
  tracker_ = VehicleTracker(options_, resolution_m_);
  ForgetStampsLocked();
}

void VehicleSession::WakeLocked() {
  if (Expired()) {
    BeginAnewLocked();
  }
  last_heard_ = Clock::now().time_since_epoch().count();
}

VehicleView VehicleSession::ViewLocked() const { return {tracker_.Estimate(), tracker_.Next(), counts_}; }

VehicleView VehicleSession::View() {
  const std::lock_guard lock(mutex_);
  if (Expired()) {
    return {std::nullopt, {}, counts_};
  }
  return ViewLocked();
}

// The vehicle's clock may be any: a pose that was set before its first message is one of the time of that message.
void VehicleSession::DatePoseLocked(std::int64_t stamp_ns) {
  if (undated_pose_) {
    tracker_ = VehicleTracker(options_, resolution_m_);
    undated_pose_->stamp_ns = stamp_ns;
    tracker_.SetPose(*undated_pose_);
    pose_set_ns_ = stamp_ns;
    undated_pose_.reset();
  }
}

bool VehicleSession::IsTooOldLocked(std::int64_t stamp_ns) const {
  return stamps_.IsTooOld(stamp_ns) || (pose_set_ns_ && stamp_ns < *pose_set_ns_ - WindowNs(options_));
}

// A picture without odometry tells nothing of the motion: odometry goes on from where it was.
std::optional<std::int64_t> VehicleSession::PreviousLocked(std::int64_t stamp_ns) const {
  const std::optional<std::int64_t> told_ns = told_.Before(stamp_ns);
  return told_ns ? told_ns : stamps_.Before(stamp_ns);
}

MessageOutcome VehicleSession::AddIncrementLocked(const OdometryMessage& message) {
  const std::int64_t stamp_ns = message.stamp_ns;
  DatePoseLocked(stamp_ns);
  std::optional<std::int64_t> from_ns = PreviousLocked(stamp_ns);
  if (!from_ns && (!stamps_.Newest() || stamps_.Contains(stamp_ns))) {
    const bool first = !stamps_.Newest();
    stamps_.Add(stamp_ns);
    told_.Add(stamp_ns);
    last_received_ns_ = stamp_ns;
    return first ? MessageOutcome::kUsed : MessageOutcome::kDuplicate;
  }
  if (!from_ns) {
    const bool follows = last_received_ns_ && *last_received_ns_ < stamp_ns;
    from_ns = follows ? *last_received_ns_ : stamp_ns - kUnknownIntervalNs;
  }
  last_received_ns_ = stamp_ns;
  const MessageOutcome outcome = tracker_.AddOdometry({*from_ns, stamp_ns, message.motion, std::nullopt});
  if (outcome == MessageOutcome::kClockJump) {
    ForgetStampsLocked();
  }
  if (IsUsed(outcome)) {
    stamps_.Add(stamp_ns);
    told_.Add(stamp_ns);
    frames_before_history_ = 0;
  }
  return outcome;
}

OdometryReport VehicleSession::AddOdometry(const std::vector<OdometryMessage>& increments) {
  const std::lock_guard lock(mutex_);
  WakeLocked();
  OdometryReport report;
  for (const OdometryMessage& increment : increments) {
    report.messages.push_back(AddIncrementLocked(increment));
    ++counts_.messages[static_cast<std::size_t>(report.messages.back())];
  }
  report.view = ViewLocked();
  return report;
}

VehicleView VehicleSession::SetPose(PoseFix pose, std::optional<std::int64_t> stamp_ns) {
  const std::lock_guard lock(mutex_);
  WakeLocked();
  pose.stamp_ns = stamp_ns ? *stamp_ns : stamps_.Newest().value_or(UnixNowNs());
  if (IsTooOldLocked(pose.stamp_ns)) {
    BeginAnewLocked();
  }
  tracker_.SetPose(pose);
  undated_pose_.reset();
  pose_set_ns_ = pose.stamp_ns;
  if (!stamp_ns && !stamps_.Newest()) {
    undated_pose_ = pose;
  }
  return ViewLocked();
}

// The time of a picture that comes without odometry. The tracker notices by odometry only that a clock was set.
MessageOutcome VehicleSession::NoteFrameLocked(std::int64_t stamp_ns) {
  const bool too_old = IsTooOldLocked(stamp_ns);
  if (too_old && ++frames_before_history_ < options_.filter.clock_jump_messages) {
    return MessageOutcome::kTooOld;
  }
  if (too_old) {
    BeginAnewLocked();
  }
  frames_before_history_ = 0;
  const bool late = stamp_ns < stamps_.Newest().value_or(stamp_ns);
  stamps_.Add(stamp_ns);
  last_received_ns_ = stamp_ns;
  if (too_old) {
    return MessageOutcome::kClockJump;
  }
  return late ? MessageOutcome::kUsedLate : MessageOutcome::kUsed;
}

std::optional<FrameTurn> VehicleSession::BeginFrame(std::int64_t stamp_ns, const std::optional<Pose2>& motion) {
  FrameTurn turn;
  turn.turn = std::unique_lock(frame_mutex_, std::try_to_lock);
  if (!turn.turn.owns_lock()) {
    return std::nullopt;
  }
  const std::lock_guard lock(mutex_);
  WakeLocked();
  DatePoseLocked(stamp_ns);
  turn.stamp_ns = stamp_ns;
  // A picture that is sent again after an error brings odometry that is known, but is new itself.
  const MessageOutcome odometry = motion ? AddIncrementLocked({stamp_ns, *motion}) : MessageOutcome::kDuplicate;
  if (frames_.Contains(stamp_ns)) {
    turn.message = MessageOutcome::kDuplicate;
  } else {
    turn.message = odometry == MessageOutcome::kDuplicate ? NoteFrameLocked(stamp_ns) : odometry;
  }
  turn.epoch = epoch_;
  turn.prior = tracker_.Prior(stamp_ns);
  return turn;
}

FrameReport VehicleSession::FinishFrame(const FrameTurn& turn, const Features& features,
                                        const LocalizationResult& found) {
  const std::lock_guard lock(mutex_);
  FrameReport report;
  report.message = turn.epoch == epoch_ ? turn.message : MessageOutcome::kTooOld;
  if (IsUsed(report.message)) {
    frames_.Add(turn.stamp_ns);
    report.fix = tracker_.AddFrame(turn.stamp_ns, features, found).fix;
  } else if (found.status == LocalizationStatus::kLocalized) {
    report.fix = FixOutcome();
    report.fix->reason =
        report.message == MessageOutcome::kDuplicate ? FixRejection::kDuplicate : FixRejection::kTooOld;
  }
  CountLocked(report);
  report.view = ViewLocked();
  return report;
}

void VehicleSession::CountLocked(const FrameReport& report) {
  ++counts_.messages[static_cast<std::size_t>(report.message)];
  if (report.fix && report.fix->accepted) {
    ++counts_.accepted;
    counts_.reanchored += report.fix->reanchored ? 1 : 0;
  } else if (report.fix) {
    ++counts_.rejected[static_cast<std::size_t>(report.fix->reason)];
  }
}

}  // namespace floorloc
