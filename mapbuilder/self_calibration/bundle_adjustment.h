// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/geometry/pose2.h"
#include "mapbuilder/placement/pose_graph.h"
#include "mapbuilder/self_calibration/camera_adjustment.h"

namespace floorloc {

/// A floor point as a frame saw it, and how that changes with the camera and with the frame's own tilt.
struct Observation {
  int frame = 0;
  Eigen::Vector2d point_in_base_m = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, kCameraUnknowns> by_camera = Eigen::Matrix<double, 2, kCameraUnknowns>::Zero();
  Eigen::Matrix<double, 2, 3> by_tilt = Eigen::Matrix<double, 2, 3>::Zero();  ///< roll, pitch, height share
};

/// Observations of one unknown floor point.
struct ObservedTrack {
  std::vector<Observation> observations;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< map frame
};

/// A floor point whose map position was surveyed.
struct ObservedControlPoint {
  Observation observation;
  Eigen::Vector2d point_in_map_m = Eigen::Vector2d::Zero();
  double sigma_m = 1e-3;
};

/// Two floor points whose distance was measured.
struct ObservedDistance {
  Observation first;
  Observation second;
  double distance_m = 0.0;
  double sigma_m = 1e-3;
};

/// Standard deviations of what is not known exactly; 0: known exactly.
struct BundlePriors {
  std::array<double, kCameraUnknowns> camera{};  ///< of each camera's unknowns
  double tilt_rad = 0.0;                         ///< of a frame's own roll and pitch: vibration
  double tilt_height = 0.0;                      ///< and of its height, as a share
};

/// Everything the adjustment moves or holds on to.
struct Bundle {
  std::vector<Pose2> map_from_base;
  std::vector<int> camera_of_frame;
  std::vector<CameraAdjustment> cameras;  ///< result: one per camera, starts at zero
  std::vector<Eigen::Vector3d> tilts;     ///< result: one per frame, starts at zero
  std::vector<ObservedTrack> tracks;
  std::vector<ObservedControlPoint> control_points;
  std::vector<ObservedDistance> distances;
  std::vector<PosePriorFactor> priors;
  std::vector<Link> odometry;
  std::vector<int> fixed;               ///< frames that do not move
  double observation_sigma_m = 2.5e-4;  ///< of a keypoint's coordinates
  BundlePriors prior;
};

struct BundleSummary {
  bool converged = false;
  double rms_before_m = 0.0;  ///< of an observation's distance from its track's point
  double rms_after_m = 0.0;
  std::vector<CameraAdjustment> camera_sigma;  ///< standard deviations of `cameras`; the prior's where nothing is seen
};

/// Adjusts poses, floor points, cameras and tilts at once (bundle adjustment; Triggs et al. 2000) under a Cauchy loss,
/// floor points eliminated first. To first order in cameras and tilts: rebuild the observations and iterate for large
/// ones.
BundleSummary AdjustBundle(Bundle* bundle);

}  // namespace floorloc
