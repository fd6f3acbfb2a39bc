// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "core/geometry/camera.h"
#include "core/odometry/point_tracker.h"

namespace floorloc {

struct MonocularOdometryOptions {
  PointTrackerOptions tracker;
  double noise_px = 0.5;               ///< of a tracked point
  double min_parallax_px = 3.0;        ///< with less displacement beyond a rotation the translation is unobservable
  double keyframe_parallax_px = 12.0;  ///< above it: next keyframe
  int min_points = 30;                 ///< fewer tracked points: lost
  double min_inlier_share = 0.5;       ///< share of the tracked points that agree with a motion; fewer: lost

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
};

enum class MonocularStatus {
  kFirstFrame,
  kTracked,
  kRotated,  ///< only the rotation is known, the position is kept: standing still, turning on the spot, or just begun
  kLost,     ///< too few points were tracked or agree; tracking restarts with this frame at the last pose
};

const char* ToString(MonocularStatus status);

struct MonocularOdometryResult {
  MonocularStatus status = MonocularStatus::kFirstFrame;
  /// x right, y down, z forward along the optical axis; the world is the first frame's camera.
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  int tracked = 0;           ///< points tracked since the keyframe
  int inliers = 0;           ///< of them, those that agree with the motion
  double parallax_px = 0.0;  ///< median displacement since the keyframe beyond the best rotation
  bool new_keyframe = false;
  int scale_breaks = 0;  ///< how often the scale could not be propagated from one keyframe to the next
};

/// Monocular visual odometry for cameras in any orientation: points of ORB, BRISK or AKAZE, tracked by Lucas-Kanade;
/// the essential matrix between a keyframe and the frame by the five-point algorithm in RANSAC. The scale is not
/// observable: the first translation between keyframes has length one, and points triangulated from one pair of
/// keyframes give the length of the next. External positions (wheels, GNSS), where given, set the length instead. The
/// scene must have depth: on a single plane, such as a floor, the essential matrix is ambiguous. Deterministic; bounded
/// state.
class MonocularOdometry {
 public:
  /// Throws std::invalid_argument on a bad camera or bad options.
  MonocularOdometry(const CameraModel& camera, const MonocularOdometryOptions& options);
  ~MonocularOdometry();
  MonocularOdometry(MonocularOdometry&&) noexcept;
  MonocularOdometry& operator=(MonocularOdometry&&) noexcept;

  /// raw: CV_8UC1 of the camera's size. position_m: of the camera at that time in any fixed frame; only distances
  /// between keyframes are used. Throws std::invalid_argument when the stamp is not after the previous one or the
  /// image's size is wrong.
  MonocularOdometryResult Track(std::int64_t stamp_ns, const cv::Mat& raw,
                                const std::optional<Eigen::Vector3d>& position_m = std::nullopt);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace floorloc
