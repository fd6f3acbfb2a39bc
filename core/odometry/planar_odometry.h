// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>

#include "core/geometry/pose2.h"
#include "core/odometry/floor_view.h"
#include "core/odometry/motion_covariance.h"
#include "core/vision/features/features.h"

namespace floorloc {

struct PlanarOdometryOptions {
  /// Lengths are for images of 0.7 mm per pixel and are scaled to resolution_m.
  RegistrationOptions registration = DefaultRegistration();
  double resolution_m = 7e-4;       ///< of the rectified images
  float max_ratio_binary = 0.9F;    ///< ratio test, binary descriptors
  float max_ratio_float = 0.85F;    ///< ratio test, float descriptors
  double systematic_m = 4e-4;       ///< error of a registration that its residuals do not show (vibration, calibration)
  double systematic_rad = 2e-4;     ///< the same for the heading
  double min_inlier_share = 0.1;    ///< of the keypoints on the common floor; fewer: lost
  double min_overlap = 0.6;         ///< share of a frame's keypoints on the keyframe's floor; less: next keyframe
  double max_speed_m_s = 3.0;       ///< faster motions are rejected, and not searched for
  double max_yaw_rate_rad_s = 6.0;  ///< the same for turns
  double max_guess_error_m = 0.1;   ///< motions farther from a given guess, plus half its length, are rejected
  double max_guess_error_rad = 0.35;  ///< the same for turns

  static RegistrationOptions DefaultRegistration();
  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
};

/// Motion of the base between two frames.
struct VisualMotion {
  std::int64_t from_ns = 0;
  std::int64_t to_ns = 0;
  Pose2 from_from_to;  ///< pose of the base at to_ns in the base frame at from_ns
  /// Of (x, y, yaw), additive in the base frame at from_ns; for filters that take motions as independent. Frames are
  /// measured against a keyframe, so their errors do not add up until the next keyframe: this is what the motion adds
  /// to the uncertainty of the motion since the keyframe. While the robot stands still that is next to nothing.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  /// The same of this motion alone, errors of both ends: consecutive motions share one of them, with opposite signs.
  Eigen::Matrix3d covariance_alone = Eigen::Matrix3d::Zero();
  int matches = 0;
  int inliers = 0;
  double rms_m = 0.0;    ///< residual of the inliers
  double overlap = 0.0;  ///< share of the frame's keypoints that lie on the keyframe's floor
};

enum class PlanarOdometryStatus {
  kFirstFrame,  ///< nothing to compare with yet
  kTracked,     ///< there is a motion
  kLost,        ///< the motion of the base is unknown; `loss` gives the reason
};

enum class TrackingLoss {
  kNone,
  kTooFewKeypoints,
  kTooFewMatches,
  kTooFewInliers,
  kNotSignificant,    ///< no more agreement than chance, or too little of the common floor agrees
  kAmbiguous,         ///< several motions explain the frame
  kTooFast,           ///< the motion found exceeds the speed limits
  kContradictsGuess,  ///< the motion found is far from the guess given
};

const char* ToString(PlanarOdometryStatus status);
const char* ToString(TrackingLoss loss);

struct PlanarOdometryResult {
  PlanarOdometryStatus status = PlanarOdometryStatus::kFirstFrame;
  TrackingLoss loss = TrackingLoss::kNone;
  std::optional<VisualMotion> motion;  ///< when tracked
  /// All motions in a row, in the frame of the first frame's base. A lost frame has the pose of its guess, or the last
  /// known one; when tracking continues from such a frame, `chain` counts up.
  Pose2 odom_from_base;
  int chain = 0;  ///< poses of one number are connected by measured motions
  bool new_keyframe = false;
};

/// Planar visual odometry of one camera: every frame is registered to a keyframe, which is kept while it shares enough
/// floor with the frames, so that standing still or moving slowly does not drift. The motions in a row are the
/// keyframes' poses times the registrations. After a loss the frame is registered to the keyframe, to the last frame
/// that was tracked, and to the last one that was not. Deterministic; holds three frames' features at most.
class PlanarOdometry {
 public:
  /// Throws std::invalid_argument on bad options.
  explicit PlanarOdometry(const PlanarOdometryOptions& options);
  ~PlanarOdometry();
  PlanarOdometry(PlanarOdometry&&) noexcept;
  PlanarOdometry& operator=(PlanarOdometry&&) noexcept;

  /// features: of one extractor, keypoints in the base frame. guess: motion of the base since the previous frame, by
  /// wheel odometry. Throws std::invalid_argument when the stamp is not after the previous frame's or the guess is not
  /// finite; the state is as before then.
  PlanarOdometryResult Track(std::int64_t stamp_ns, const Features& features,
                             const std::optional<Pose2>& guess = std::nullopt);

  /// Forgets all frames: the next one is the first.
  void Reset();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace floorloc
