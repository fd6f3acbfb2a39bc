// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "core/geometry/floor_plane.h"
#include "core/geometry/pose2.h"
#include "core/registration/registration.h"
#include "core/vision/features/features.h"
#include "core/vision/matching/guided_matcher.h"

namespace floorloc {

/// Predicted pose of a frame in the frame of another one, and the search radius about it.
struct ViewGuess {
  Pose2 view_from_base;
  double radius_m = 0.0;
  double yaw_radius_rad = 0.0;
};

struct ViewRegistrationOptions {
  RegistrationOptions registration;  ///< scaled to the images' resolution
  double resolution_m = 7e-4;
  float max_ratio_binary = 0.9F;
  float max_ratio_float = 0.85F;
  double systematic_m = 1e-4;    ///< errors not in the residuals (calibration, vibration), per registration
  double systematic_rad = 2e-4;  ///< the same for the heading
  double min_inlier_share = 0.1;
  /// Largest share of the common floor that something else may cover: a part of the robot stands still in the image
  /// while the floor moves. As DecisionOptions::local_share.
  double local_share = 0.35;
  /// Least share of inliers among the keypoints beside the local_share of the common floor that agrees best. A part of
  /// 30 % of the image leaves 0 to 0.02 there, frames with few inliers (0.1 of all) 0.045: `./run bench odometry`.
  double min_rest_share = 0.03;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Registration of a frame to a view.
struct ViewRegistration {
  RegistrationStatus status = RegistrationStatus::kTooFewMatches;
  Pose2 view_from_base;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of (x, y, yaw), additive in the view's frame
  int matches = 0;
  int inliers = 0;
  double rms_m = 0.0;
  double overlap = 0.0;  ///< share of the frame's keypoints on the floor of the view

  bool ok() const { return status == RegistrationStatus::kRegistered; }
};

/// A frame that others are registered to. Immutable after construction.
class FloorView {
 public:
  /// Copies the features; keypoints in the base frame. resolution_m: of the rectified image.
  FloorView(std::int64_t stamp_ns, const Features& features, double resolution_m);

  /// Matching near the guess, voting and RANSAC; then every keypoint is matched again near the position that the pose
  /// predicts. kNotSignificant when too small a share of the keypoints on the common floor agrees, kViewDisagrees when
  /// those that agree lie in one part of it: something that travels with the camera stands still, not the vehicle.
  ViewRegistration Register(const Features& frame, const ViewGuess& guess,
                            const ViewRegistrationOptions& options) const;

  std::int64_t stamp_ns() const { return stamp_ns_; }
  /// Diagonal of the floor that the keypoints cover, metres.
  double diagonal_m() const { return Eigen::Vector2d(floor_.width_m(), floor_.height_m()).norm(); }

 private:
  std::vector<OrientedMatch> FindMatches(const Features& frame, const ViewGuess& guess,
                                         const ViewRegistrationOptions& options) const;

  std::int64_t stamp_ns_;
  Features features_;
  RectM floor_;  // bounds of the keypoints
  GuidedMatcher matcher_;
};

}  // namespace floorloc
