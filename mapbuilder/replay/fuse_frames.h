// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/tracking/vehicle_tracker.h"
#include "mapbuilder/replay/localize_frames.h"

namespace floorloc {

struct FuseFramesOptions {
  TrackerOptions tracker;
  bool use_prior = true;  ///< false: every frame on the whole map
  bool use_imu = true;
  bool dense = false;  ///< poses at every message, not at the frames only
  ProgressOutput progress;
};

/// One frame's answer, and its outcome.
struct FusedFrame {
  LocalizedFrame localized;
  FrameOutcome outcome;
  std::optional<FusedPose> pose;  ///< after the frame; empty before the first fix
};

struct FusedDrive {
  std::vector<FusedFrame> frames;
  std::vector<FusedPose> poses;  ///< by time: at the frames, or at every message
};

/// Throws InputError when the axes of imu.csv are not those of the base frame, by where gravity is.
void CheckImuAxes(const Survey& survey);

/// Runs a recorded drive through a vehicle's tracker as it would have run then: every message at its time, no
/// look-ahead. Odometry and IMU are used where the folder has them. Throws InputError, also when the IMU's axes are not
/// those of the base frame.
FusedDrive FuseFrames(const Localizer& localizer, const Survey& survey, const FuseFramesOptions& options);

/// One line of the --results file: that of the fix, with the fused pose and what became of the fix.
std::string ToJsonLine(const FusedFrame& frame);

/// The poses that the tracker reports as localized: without those where it was lost or contradicted by the last image.
Trajectory ToTrajectory(const std::vector<FusedPose>& poses);

}  // namespace floorloc
