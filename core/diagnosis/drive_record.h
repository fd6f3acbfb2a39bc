// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "core/diagnosis/stamp_series.h"
#include "core/fusion/fused_pose.h"
#include "core/localization/localization_result.h"

namespace floorloc {

/// How much of a drive is remembered; a recorded drive is remembered as a whole.
struct DriveRecordOptions {
  std::size_t max_frames = 100;     ///< a minute or two of a vehicle that sends as it is asked to
  std::size_t max_odometry = 1000;  ///< messages: 10 s and more at 100 per second

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// What became of one image.
struct RecordedFrame {
  std::int64_t stamp_ns = 0;
  LocalizationStatus status = LocalizationStatus::kNotLocalized;
  NotLocalizedReason reason = NotLocalizedReason::kNone;
  Pose2 map_from_base;                    ///< when localized
  std::optional<Pose2> odom_from_base;    ///< as fused, at the image; empty before the first fix
  std::optional<OdometryTrust> odometry;  ///< likewise; empty without odometry

  /// fused: after the image.
  static RecordedFrame Of(std::int64_t stamp_ns, const LocalizationResult& found,
                          const std::optional<FusedPose>& fused);
  bool IsLocalized() const { return status == LocalizationStatus::kLocalized; }
};

/// The last images and odometry messages of a vehicle. Bounded memory.
class DriveRecord {
 public:
  /// Throws std::invalid_argument when the options do not pass Check().
  explicit DriveRecord(const DriveRecordOptions& options = {});

  void AddFrame(const RecordedFrame& frame);
  /// Of a message, whether it was used or not.
  void AddOdometry(std::int64_t stamp_ns);

  const std::deque<RecordedFrame>& frames() const { return frames_; }
  const StampSeries& frame_stamps() const { return frame_stamps_; }
  const StampSeries& odometry_stamps() const { return odometry_stamps_; }
  /// Images that came after the last odometry message.
  std::size_t frames_since_odometry() const { return frames_since_odometry_; }

 private:
  DriveRecordOptions options_;
  std::deque<RecordedFrame> frames_;
  StampSeries frame_stamps_;
  StampSeries odometry_stamps_;
  std::size_t frames_since_odometry_ = 0;
};

}  // namespace floorloc
