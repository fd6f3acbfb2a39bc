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
  double systematic_m = 4e-4;       ///< error of a registration not in its residuals (vibration, calibration)
  double systematic_rad = 2e-4;     ///< the same for the heading
  double min_inlier_share = 0.1;    ///< of the keypoints on the common floor; fewer: lost
  double min_overlap = 0.6;         ///< share of a frame's keypoints on the floor of the keyframe; less: next keyframe
  double max_speed_m_s = 3.0;       ///< faster motions are neither searched nor accepted
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
  /// Of (x, y, yaw), additive in the base frame at from_ns; for filters that treat motions as independent. Frames are
  /// registered to a keyframe, so their errors do not accumulate until the next one: this is the increment of the
  /// covariance since the keyframe, close to zero at standstill.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  /// Covariance of this motion alone, with the errors of both ends: consecutive motions share one of them, with
  /// opposite signs.
  Eigen::Matrix3d covariance_alone = Eigen::Matrix3d::Zero();
  int matches = 0;
  int inliers = 0;
  double rms_m = 0.0;    ///< residual of the inliers
  double overlap = 0.0;  ///< share of the frame's keypoints on the floor of the keyframe
};

enum class PlanarOdometryStatus {
  kFirstFrame,  ///< no previous frame
  kTracked,     ///< `motion` is set
  kLost,        ///< the motion of the base is unknown; `loss` gives the reason
};

enum class TrackingLoss {
  kNone,
  kTooFewKeypoints,
  kTooFewMatches,
  kTooFewInliers,
  kNotSignificant,    ///< the agreement may be chance, or too few keypoints of the common floor agree
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
  /// All motions composed; odom is the base frame of the first frame. A lost frame has the pose of its guess, or the
  /// last known one; when tracking continues from a lost frame, `chain` is incremented.
  Pose2 odom_from_base;
  int chain = 0;  ///< poses with the same number are connected by measured motions
  bool new_keyframe = false;
};

/// Planar visual odometry of one camera: every frame is registered to a keyframe, which is kept while it overlaps
/// enough with the frames, so that standing still or moving slowly does not drift. The pose is that of the keyframe
/// times the registration. A frame that cannot be registered to the keyframe is registered to the last tracked frame,
/// then to the last lost one. Deterministic; keeps the features of at most three frames.
class PlanarOdometry {
 public:
  /// Throws std::invalid_argument on bad options.
  explicit PlanarOdometry(const PlanarOdometryOptions& options);
  ~PlanarOdometry();
  PlanarOdometry(PlanarOdometry&&) noexcept;
  PlanarOdometry& operator=(PlanarOdometry&&) noexcept;

  /// features: of one extractor, keypoints in the base frame. guess: motion of the base since the previous frame, by
  /// wheel odometry. Throws std::invalid_argument when the stamp is not after the previous frame's or the guess is not
  /// finite; the state is then unchanged.
  PlanarOdometryResult Track(std::int64_t stamp_ns, const Features& features,
                             const std::optional<Pose2>& guess = std::nullopt);

  /// Drops all frames: the next one is a first frame.
  void Reset();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace floorloc
