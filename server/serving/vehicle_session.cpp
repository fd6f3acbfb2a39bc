// SPDX-License-Identifier: Apache-2.0
#include "server/serving/vehicle_session.h"

#include <cmath>

namespace floorloc {
namespace {

// Assumed duration of an increment without an earlier message of the vehicle.
constexpr std::int64_t kUnknownIntervalNs = 100'000'000;

std::int64_t WindowNs(const TrackerOptions& options) {
  return static_cast<std::int64_t>(std::llround(1e9 * options.filter.history_s));
}

std::int64_t UnixNowNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

// Empty: the odometry is not rejected.
std::optional<OdometryFault> RejectedFor(const VehicleView& view) {
  const bool rejected = view.fused && view.fused->odometry && view.fused->odometry->health == OdometryHealth::kRejected;
  return rejected ? std::optional(view.fused->odometry->fault) : std::nullopt;
}

bool IsUsed(MessageOutcome message) {
  return message == MessageOutcome::kUsed || message == MessageOutcome::kUsedLate ||
         message == MessageOutcome::kClockJump;
}

}  // namespace

const char* ToString(LostReason reason) { return reason == LostReason::kMapChanged ? "map_changed" : ""; }

VehicleSession::VehicleSession(const TrackerOptions& options, double resolution_m, double timeout_s)
    : options_(options),
      timeout_s_(timeout_s),
      last_message_time_(Clock::now().time_since_epoch().count()),
      tracker_(options, resolution_m),
      stamps_(WindowNs(options)),
      odometry_stamps_(WindowNs(options)),
      frames_(WindowNs(options)) {}

double VehicleSession::SecondsSinceLastMessage() const {
  const Clock::duration last_message_time(last_message_time_.load());
  return std::chrono::duration<double>(Clock::now().time_since_epoch() - last_message_time).count();
}

void SessionStart::GoOnFrom(const PoseFix& last_pose, bool same_frame) {
  if (same_frame) {
    pose = last_pose;
  } else {
    ++epoch;
    lost_reason = LostReason::kMapChanged;
  }
}

void VehicleSession::Start(const SessionStart& start) {
  const std::lock_guard lock(mutex_);
  counts_ = start.counts;
  epoch_ = start.epoch - counts_.reanchored;
  lost_reason_ = start.lost_reason;
  last_message_time_ -=
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(start.silent_s)).count();
  if (start.pose) {
    tracker_.SetPose(*start.pose);
    pose_set_ns_ = started_ns_ = start.pose->stamp_ns;
    ++poses_set_;
  }
}

void VehicleSession::ClearStampsLocked() {
  stamps_.Clear();
  odometry_stamps_.Clear();
  frames_.Clear();
  last_received_ns_.reset();
  newest_image_ns_ = 0;
  pose_set_ns_.reset();
  started_ns_.reset();
  unstamped_pose_.reset();
  frames_before_history_ = 0;
  lost_reason_ = LostReason::kNone;
  ++epoch_;
}

void VehicleSession::RestartLocked() {
  tracker_.Restart();
  ClearStampsLocked();
}

void VehicleSession::RestartIfExpiredLocked() {
  if (Expired()) {
    RestartLocked();
    record_ = DriveRecord();
  }
  last_message_time_ = Clock::now().time_since_epoch().count();
  ++changes_;
}

VehicleView VehicleSession::ViewLocked() const {
  VehicleView view{tracker_.Estimate(), tracker_.Next(), counts_, SecondsSinceLastMessage(),
                   epoch_ + poses_set_ + counts_.reanchored};
  view.lost_reason = view.fused ? LostReason::kNone : lost_reason_;
  view.alternatives = tracker_.Alternatives();
  view.alternatives_ns = newest_image_ns_;
  return view;
}

VehicleView VehicleSession::View() {
  const std::lock_guard lock(mutex_);
  if (Expired()) {
    return {std::nullopt, {}, counts_, SecondsSinceLastMessage(), epoch_ + poses_set_ + counts_.reanchored};
  }
  return ViewLocked();
}

CameraEstimate VehicleSession::Camera() {
  const std::lock_guard lock(mutex_);
  return tracker_.Camera();
}

LearntValues VehicleSession::Learnt() {
  const std::lock_guard lock(mutex_);
  return tracker_.Learnt();
}

void VehicleSession::Resume(const LearntValues& learnt) {
  const std::lock_guard lock(mutex_);
  tracker_.Resume(learnt);
}

DriveRecord VehicleSession::Record() {
  const std::lock_guard lock(mutex_);
  return record_;
}

LearnedMaskState VehicleSession::Mask() {
  const std::lock_guard lock(mutex_);
  return tracker_.Mask();
}

// The vehicle's clock is unknown before its first message: a pose set earlier gets the time of that message.
void VehicleSession::StampPoseLocked(std::int64_t stamp_ns) {
  if (started_ns_ && stamp_ns < *started_ns_ - WindowNs(options_)) {
    RestartLocked();  // its clock was set since the pose, so nothing tells how old that is
  }
  started_ns_.reset();
  if (unstamped_pose_) {
    tracker_.Restart();
    unstamped_pose_->stamp_ns = stamp_ns;
    tracker_.SetPose(*unstamped_pose_);
    pose_set_ns_ = stamp_ns;
    unstamped_pose_.reset();
  }
}

bool VehicleSession::IsTooOldLocked(std::int64_t stamp_ns) const {
  return stamps_.IsTooOld(stamp_ns) || (pose_set_ns_ && stamp_ns < *pose_set_ns_ - WindowNs(options_));
}

// An image without odometry has no increment, so the next increment starts at the last stamp with odometry.
std::optional<std::int64_t> VehicleSession::PreviousLocked(std::int64_t stamp_ns) const {
  const std::optional<std::int64_t> odometry_ns = odometry_stamps_.Before(stamp_ns);
  return odometry_ns ? odometry_ns : stamps_.Before(stamp_ns);
}

MessageOutcome VehicleSession::AddIncrementLocked(const OdometryMessage& message) {
  const std::int64_t stamp_ns = message.stamp_ns;
  StampPoseLocked(stamp_ns);
  std::optional<std::int64_t> from_ns = PreviousLocked(stamp_ns);
  if (!from_ns && (!stamps_.Newest() || stamps_.Contains(stamp_ns))) {
    const bool first = !stamps_.Newest();
    stamps_.Add(stamp_ns);
    odometry_stamps_.Add(stamp_ns);
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
    ClearStampsLocked();
  }
  if (IsUsed(outcome)) {
    stamps_.Add(stamp_ns);
    odometry_stamps_.Add(stamp_ns);
    frames_before_history_ = 0;
  }
  return outcome;
}

OdometryReport VehicleSession::AddOdometry(const std::vector<OdometryMessage>& increments) {
  const std::lock_guard lock(mutex_);
  RestartIfExpiredLocked();
  OdometryReport report;
  for (const OdometryMessage& increment : increments) {
    record_.AddOdometry(increment.stamp_ns);
    report.messages.push_back(AddIncrementLocked(increment));
    ++counts_.messages[report.messages.back()];
  }
  report.view = ViewLocked();
  return report;
}

VehicleView VehicleSession::SetPose(PoseFix pose, std::optional<std::int64_t> stamp_ns) {
  const std::lock_guard lock(mutex_);
  RestartIfExpiredLocked();
  pose.stamp_ns = stamp_ns ? *stamp_ns : stamps_.Newest().value_or(UnixNowNs());
  if (IsTooOldLocked(pose.stamp_ns)) {
    RestartLocked();
  }
  tracker_.SetPose(pose);
  ++poses_set_;
  unstamped_pose_.reset();
  pose_set_ns_ = pose.stamp_ns;
  if (!stamp_ns && !stamps_.Newest()) {
    unstamped_pose_ = pose;
  }
  return ViewLocked();
}

// Records the stamp of an image without odometry. The tracker detects clock jumps from odometry only.
MessageOutcome VehicleSession::RecordFrameStampLocked(std::int64_t stamp_ns) {
  const bool too_old = IsTooOldLocked(stamp_ns);
  if (too_old && ++frames_before_history_ < options_.filter.clock_jump_messages) {
    return MessageOutcome::kTooOld;
  }
  if (too_old) {
    RestartLocked();
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

std::optional<FrameSlot> VehicleSession::BeginFrame(const FrameMessage& message, double max_wait_s) {
  const std::int64_t stamp_ns = message.stamp_ns;
  FrameSlot slot;
  slot.lock = std::unique_lock(frame_mutex_, std::chrono::duration<double>(max_wait_s));
  if (!slot.lock.owns_lock()) {
    return std::nullopt;
  }
  const std::lock_guard lock(mutex_);
  RestartIfExpiredLocked();
  StampPoseLocked(stamp_ns);
  slot.stamp_ns = stamp_ns;
  slot.image_ns = stamp_ns + message.to_middle_row_ns;
  // An image that is resent after an error repeats known odometry, but the image itself is new.
  const MessageOutcome odometry =
      message.motion ? AddIncrementLocked({stamp_ns, *message.motion}) : MessageOutcome::kDuplicate;
  if (odometry != MessageOutcome::kDuplicate) {
    record_.AddOdometry(stamp_ns);
  }
  if (frames_.Contains(stamp_ns)) {
    slot.message = MessageOutcome::kDuplicate;
  } else {
    slot.message = odometry == MessageOutcome::kDuplicate ? RecordFrameStampLocked(stamp_ns) : odometry;
  }
  slot.epoch = epoch_;
  slot.prior = tracker_.Prior(slot.image_ns);
  slot.camera_prior = tracker_.PriorOfCamera();
  slot.mask = tracker_.Mask();
  slot.motion = tracker_.Motion(slot.image_ns);
  return slot;
}

FrameReport VehicleSession::FinishFrame(const FrameSlot& slot, const Features& features,
                                        const LocalizationResult& found, const GroundImage& floor) {
  const std::lock_guard lock(mutex_);
  FrameReport report;
  report.message = slot.epoch == epoch_ ? slot.message : MessageOutcome::kTooOld;
  if (IsUsed(report.message)) {
    frames_.Add(slot.stamp_ns);
    newest_image_ns_ = std::max(newest_image_ns_, slot.image_ns);
    report.fix = tracker_.AddFrame(slot.image_ns, features, floor, found).fix;
  } else if (found.status == LocalizationStatus::kLocalized) {
    report.fix = FixOutcome();
    report.fix->reason =
        report.message == MessageOutcome::kDuplicate ? FixRejection::kDuplicate : FixRejection::kTooOld;
  }
  if (report.message != MessageOutcome::kDuplicate) {
    record_.AddFrame(RecordedFrame::Of(slot.image_ns, found, tracker_.EstimateAt(slot.image_ns)));
  }
  CountLocked(report);
  report.view = ViewLocked();
  std::optional<OdometryFault> rejected_for = RejectedFor(report.view);
  if (rejected_for_ && rejected_for == OdometryFault::kInconsistent) {
    rejected_for = rejected_for_;  // an image that does not confirm what was named
  }
  report.odometry_changed = rejected_for_ != rejected_for;
  rejected_for_ = rejected_for;
  ++changes_;
  return report;
}

void VehicleSession::CountLocked(const FrameReport& report) {
  ++counts_.messages[report.message];
  if (report.fix && report.fix->accepted) {
    ++counts_.accepted;
    counts_.reanchored += report.fix->reanchored ? 1 : 0;
  } else if (report.fix) {
    ++counts_.rejected[report.fix->reason];
  }
}

}  // namespace floorloc
