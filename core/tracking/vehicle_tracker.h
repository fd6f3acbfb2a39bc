// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/fusion/pose_fuser.h"
#include "core/localization/localization_result.h"
#include "core/localization/moving_frame.h"
#include "core/localization/pose_prior.h"
#include "core/odometry/learned_mask.h"
#include "core/odometry/planar_odometry.h"
#include "core/tracking/frame_twist.h"
#include "core/tracking/lattice_tracker.h"
#include "core/tracking/learnt_values.h"

namespace floorloc {

/// Prior of a frame: the predicted pose, with search radii from its covariance.
struct PriorOptions {
  double sigmas = 4.0;
  double min_radius_m = 0.05;
  double max_radius_m = 0.5;  ///< above it the whole map is searched
  double min_yaw_radius_rad = 0.06;
  double max_yaw_radius_rad = 0.8;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// When the next image is needed: before the pose gets worse than FilterLimits::localized_*, and soon enough to notice
/// that the vehicle was kidnapped.
struct NextFrameOptions {
  double max_s = 1.0;
  double max_m = 0.25;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

struct TrackerOptions {
  FusionMethod method = FusionMethod::kEkf;
  PoseFilterOptions filter;
  bool visual_odometry = true;  ///< use the motion between images
  /// By which wheels may end before an image and still say where to look for its motion, seconds: they are sent some
  /// five times a second. The vehicle keeps its velocity meanwhile; braking with 2 m/s^2 it is 9 cm less far.
  double max_odometry_lag_s = 0.3;
  PriorOptions prior;
  NextFrameOptions next;
  CameraEstimatorOptions camera;
  LearnedMaskOptions mask;
  ReadoutEstimatorOptions readout;
  LatticeTrackerOptions lattice;
  FrameTwistOptions twist;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// When the next image is needed, whichever comes first; zero: now.
struct NextFrame {
  double seconds = 0.0;
  double metres = 0.0;
};

/// Effect of an image on the pose.
struct FrameOutcome {
  std::optional<FixOutcome> fix;  ///< empty: the image was not localized
  /// The fix, where the image alone does not tell its place on a floor that repeats itself and earlier ones do.
  std::optional<LatticeFix> by_drive;
  PlanarOdometryResult visual;
  bool visual_used = false;  ///< false: an image from before the last one, or no visual odometry
};

/// Estimates the pose of one vehicle from its images, odometry and IMU. Not thread-safe. The caller localizes images
/// between Prior() and AddFrame(): that is slow and needs no lock of the vehicle.
class VehicleTracker {
 public:
  /// resolution_m: of the rectified images. Throws std::invalid_argument on bad options.
  VehicleTracker(const TrackerOptions& options, double resolution_m);
  ~VehicleTracker();
  VehicleTracker(VehicleTracker&&) noexcept;
  VehicleTracker& operator=(VehicleTracker&&) noexcept;

  /// Motion by wheel odometry. After a clock jump visual odometry restarts.
  MessageOutcome AddOdometry(const MotionIncrement& increment);
  MessageOutcome AddImu(const ImuReading& reading);
  void SetPose(const PoseFix& pose);

  /// The prior for an image of this time; empty: the whole map should be searched.
  std::optional<PosePrior> Prior(std::int64_t stamp_ns) const;
  /// What is known of the camera's errors, for the next image's alignment (FrameSamples::SetCameraPrior).
  std::optional<CameraPrior> PriorOfCamera() const;
  CameraEstimate Camera() const;
  /// How the vehicle moves at an image's time, and what earlier images tell of the camera's read-out.
  FrameMotion Motion(std::int64_t stamp_ns) const;
  /// Forgets everything but what was learnt.
  void Restart();
  LearntValues Learnt() const;
  /// Starts with what was learnt of the same vehicle before; to be called before the first message.
  void Resume(const LearntValues& learnt);
  /// What was seen to travel with the camera: left_out is to be left out of the next image (Localizer::Observe).
  const LearnedMaskState& Mask() const;
  /// Adds an image after its localization.
  FrameOutcome AddFrame(std::int64_t stamp_ns, const Features& features, const LocalizationResult& found);
  /// The same, and learns from it what travels with the camera. floor: FrameObservation::floor of the image.
  FrameOutcome AddFrame(std::int64_t stamp_ns, const Features& features, const GroundImage& floor,
                        const LocalizationResult& found);

  /// At the newest message; empty before the first fix.
  std::optional<FusedPose> Estimate() const;
  std::optional<FusedPose> EstimateAt(std::int64_t stamp_ns) const;
  /// Where the vehicle may be at the last image, with their probabilities, the likeliest first, while the images so far
  /// do not tell its place on a floor that repeats itself; else empty.
  std::vector<PoseHypothesis> Alternatives() const;
  NextFrame Next() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace floorloc
