// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/tracking/vehicle_tracker.h"
#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/replay/localize_frames.h"

namespace floorloc {

struct FuseFramesOptions {
  TrackerOptions tracker;
  bool use_prior = true;  ///< false: global search for every frame
  bool use_imu = true;
  bool correct_camera = true;  ///< by the map's self-calibration, if the camera is that of one of its surveys
  bool dense = false;          ///< poses at every message instead of at the frames only
  RunOptions run;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Localization result of one frame and its outcome in the tracker.
struct FusedFrame {
  LocalizedFrame localized;
  FrameOutcome outcome;
  std::optional<FusedPose> pose;             ///< after the frame; empty before the first fix
  std::vector<PoseHypothesis> alternatives;  ///< after the frame, see VehicleTracker::Alternatives
  double learnt_share = 0.0;                 ///< LearnedMaskState::share after the frame
};

struct FusedDrive {
  std::vector<FusedFrame> frames;
  std::vector<FusedPose> poses;  ///< ordered by time: at the frames, or at every message
  CameraEstimate camera;         ///< at the end
  LearnedMaskState mask;         ///< at the end
  double camera_off_px = 0.0;    ///< LargestDisplacementPx of its errors
};

/// Throws InputError when gravity shows that the axes of imu.csv are not those of the base frame.
void CheckImuAxes(const Survey& survey);

/// Throws InputError, with both ranges and what to do, when the stamps of odometry.tum or of a used imu.csv do not
/// overlap those of the images.
void CheckClocks(const Survey& survey, bool use_imu);

/// Replays a recorded drive through a vehicle's tracker as it would have run online: messages in order of time, without
/// look-ahead. Uses odometry and IMU if the folder has them. Throws InputError, also when the IMU's axes are not those
/// of the base frame, or clocks are foreign.
FusedDrive FuseFrames(const Localizer& localizer, const Survey& survey, const FuseFramesOptions& options);

/// One line of the --results file: the localization result with the fused pose and the outcome of the fix.
std::string ToJsonLine(const FusedFrame& frame);

/// Poses that the tracker reports as localized, without those where it was lost or contradicted by the last image.
Trajectory ToTrajectory(const std::vector<FusedPose>& poses);

}  // namespace floorloc
