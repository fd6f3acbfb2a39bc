// SPDX-License-Identifier: Apache-2.0
#include "core/diagnosis/drive_record.h"

#include "core/geometry/option_check.h"

namespace floorloc {

void DriveRecordOptions::Check() const {
  RequireOption(max_frames >= 1, "max_frames must be at least 1");
  RequireOption(max_odometry >= 1, "max_odometry must be at least 1");
}

RecordedFrame RecordedFrame::Of(std::int64_t stamp_ns, const LocalizationResult& found,
                                const std::optional<FusedPose>& fused) {
  RecordedFrame frame{stamp_ns, found.status, found.reason, found.map_from_base, std::nullopt, std::nullopt};
  if (fused) {
    frame.odom_from_base = fused->odom_from_base;
    frame.odometry = fused->odometry;
  }
  return frame;
}

DriveRecord::DriveRecord(const DriveRecordOptions& options)
    : options_((options.Check(), options)), frame_stamps_(options.max_frames), odometry_stamps_(options.max_odometry) {}

void DriveRecord::AddFrame(const RecordedFrame& frame) {
  frames_.push_back(frame);
  if (frames_.size() > options_.max_frames) {
    frames_.pop_front();
  }
  frame_stamps_.Add(frame.stamp_ns);
  ++frames_since_odometry_;
}

void DriveRecord::AddOdometry(std::int64_t stamp_ns) {
  odometry_stamps_.Add(stamp_ns);
  frames_since_odometry_ = 0;
}

}  // namespace floorloc
