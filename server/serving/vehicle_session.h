// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "core/diagnosis/drive_record.h"
#include "core/tracking/vehicle_tracker.h"
#include "server/serving/message_stamps.h"

namespace floorloc {

/// How often each value of an enumeration came; its enumerators run from 0 to kCount.
template <typename Enum>
class EnumCounts {
 public:
  std::uint64_t& operator[](Enum value) { return counts_[static_cast<std::size_t>(value)]; }
  std::uint64_t operator[](Enum value) const { return counts_[static_cast<std::size_t>(value)]; }

  /// Every value of the enumeration, in its order.
  static constexpr auto Values() {
    std::array<Enum, kSize> values{};
    for (std::size_t i = 0; i < kSize; ++i) {
      values[i] = static_cast<Enum>(i);
    }
    return values;
  }

 private:
  static constexpr auto kSize = static_cast<std::size_t>(Enum::kCount);
  std::array<std::uint64_t, kSize> counts_{};
};

/// Counts of a vehicle's messages and fixes by outcome, since it was registered.
struct VehicleCounts {
  EnumCounts<MessageOutcome> messages;
  std::uint64_t accepted = 0;
  std::uint64_t reanchored = 0;       ///< some of the accepted ones
  EnumCounts<FixRejection> rejected;  ///< none under FixRejection::kNone
};

/// Why a vehicle that had a pose has none.
enum class LostReason {
  kNone,
  kMapChanged,  ///< another version of its map is served, in another frame
};
/// "", "map_changed"
const char* ToString(LostReason reason);

/// State of a vehicle at the time of its newest message.
struct VehicleView {
  std::optional<FusedPose> fused;  ///< empty before the first fix
  NextFrame next;
  VehicleCounts counts;
  double silent_s = 0.0;    ///< since the last message
  std::uint64_t epoch = 0;  ///< grows with each discontinuity of the pose: set by hand, found elsewhere, clock jump

  LostReason lost_reason = LostReason::kNone;
  /// Where it may be at its newest image, while the images so far do not tell the place on a floor that repeats itself.
  std::vector<PoseHypothesis> alternatives = {};
  std::int64_t alternatives_ns = 0;  ///< stamp of that image

  TrackingState state() const { return fused ? fused->state : TrackingState::kLost; }
};

/// How a session goes on from an earlier one of the vehicle.
struct SessionStart {
  std::uint64_t epoch = 0;  ///< of its first view, unless it starts with a pose: one more
  VehicleCounts counts;
  LostReason lost_reason = LostReason::kNone;
  std::optional<PoseFix> pose;  ///< what the vehicle does from then to its first message is unknown
  double silent_s = 0.0;        ///< since its last message

  /// The vehicle had this pose: it goes on from there, or is lost when the map has another frame now.
  void GoOnFrom(const PoseFix& last_pose, bool same_frame);
};

/// Motion in the base frame (m, rad) since the vehicle's previous message with odometry, or since its previous image
/// when there is none with odometry.
struct OdometryMessage {
  std::int64_t stamp_ns = 0;
  Pose2 motion;
};

/// Lock of a vehicle's localization: at most one of its images is localized at a time.
struct FrameSlot {
  std::unique_lock<std::timed_mutex> lock;
  std::int64_t stamp_ns = 0;  ///< of the message
  std::int64_t image_ns = 0;  ///< when the image's middle row was exposed
  std::uint64_t epoch = 0;
  MessageOutcome message = MessageOutcome::kUsed;
  std::optional<PosePrior> prior;
  std::optional<CameraPrior> camera_prior;
  LearnedMaskState mask;  ///< to be left out of the image
  FrameMotion motion;
};

/// An image that a vehicle sends.
struct FrameMessage {
  std::int64_t stamp_ns = 0;
  std::optional<Pose2> motion = std::nullopt;  ///< OdometryMessage::motion, when the image came with one
  std::int64_t to_middle_row_ns = 0;           ///< Readout::StampShiftNs of its camera
};

/// Outcome of an image.
struct FrameReport {
  MessageOutcome message = MessageOutcome::kUsed;
  std::optional<FixOutcome> fix;  ///< empty: the image was not localized
  VehicleView view;
  bool odometry_changed = false;  ///< is rejected, for another reason, or no longer, since the image before
};

struct OdometryReport {
  std::vector<MessageOutcome> messages;
  VehicleView view;
};

/// Tracks the pose of one registered vehicle. Thread-safe: mutex_ is held while messages are added, never while an
/// image is localized.
class VehicleSession {
 public:
  /// resolution_m: metres per pixel of the rectified images. timeout_s: after this time without a message the pose is
  /// dropped; 0: never.
  VehicleSession(const TrackerOptions& options, double resolution_m, double timeout_s);

  /// To be called before the first message.
  void Start(const SessionStart& start);

  /// Adds increments in the given order; one outcome each.
  OdometryReport AddOdometry(const std::vector<OdometryMessage>& increments);
  /// stamp_ns: empty means the stamp of the newest message, or before any message that of the first one to arrive.
  VehicleView SetPose(PoseFix pose, std::optional<std::int64_t> stamp_ns);

  /// Adds the odometry sent with an image, and returns the prior for its localization. Empty when another image of
  /// this vehicle is being localized, still after max_wait_s.
  std::optional<FrameSlot> BeginFrame(const FrameMessage& message, double max_wait_s = 0.0);
  /// Adds the result of localizing the image. features: of the image, base frame. floor: FrameObservation::floor of it,
  /// from which the vehicle learns what travels with its camera; without it, it does not.
  FrameReport FinishFrame(const FrameSlot& slot, const Features& features, const LocalizationResult& found,
                          const GroundImage& floor = {});

  VehicleView View();
  /// What the fixes tell of the camera's errors.
  CameraEstimate Camera();
  LearntValues Learnt();
  /// Starts with what was learnt of the same vehicle before; to be called before Start.
  void Resume(const LearntValues& learnt);
  /// The last images and odometry messages, whether they were used or not.
  DriveRecord Record();
  /// What of the view travels with the camera.
  LearnedMaskState Mask();
  double SecondsSinceLastMessage() const;
  /// Grows with every message when it is taken in, and with every image once more when it is localized: what is read
  /// after it is at least as new.
  std::int64_t Changes() const { return changes_.load(); }
  bool Expired() const { return timeout_s_ > 0.0 && SecondsSinceLastMessage() > timeout_s_; }

 private:
  using Clock = std::chrono::steady_clock;

  void RestartLocked();
  void RestartIfExpiredLocked();
  VehicleView ViewLocked() const;
  MessageOutcome AddIncrementLocked(const OdometryMessage& message);
  MessageOutcome RecordFrameStampLocked(std::int64_t stamp_ns);
  void CountLocked(const FrameReport& report);
  void ClearStampsLocked();
  void StampPoseLocked(std::int64_t stamp_ns);
  bool IsTooOldLocked(std::int64_t stamp_ns) const;
  std::optional<std::int64_t> PreviousLocked(std::int64_t stamp_ns) const;

  const TrackerOptions options_;
  const double timeout_s_;
  std::atomic<Clock::rep> last_message_time_;
  std::atomic<std::int64_t> changes_ = 0;
  std::timed_mutex frame_mutex_;  // held while an image is localized; locked before mutex_
  std::mutex mutex_;              // guards all members below
  VehicleTracker tracker_;
  MessageStamps stamps_;           // of all messages
  MessageStamps odometry_stamps_;  // of those with odometry
  MessageStamps frames_;           // of those with an image
  std::optional<std::int64_t> last_received_ns_;
  std::int64_t newest_image_ns_ = 0;
  std::optional<std::int64_t> pose_set_ns_;  // stamp of the last SetPose
  std::optional<std::int64_t> started_ns_;   // stamp of SessionStart::pose, until the first message
  std::optional<PoseFix> unstamped_pose_;    // from SetPose before the first message
  int frames_before_history_ = 0;
  std::uint64_t epoch_ = 0;  // incremented when the history restarts
  std::uint64_t poses_set_ = 0;
  LostReason lost_reason_ = LostReason::kNone;  // of a vehicle without a pose
  VehicleCounts counts_;
  DriveRecord record_;
  std::optional<OdometryFault> rejected_for_;  // after the last image; empty: the odometry is not rejected
};

}  // namespace floorloc
