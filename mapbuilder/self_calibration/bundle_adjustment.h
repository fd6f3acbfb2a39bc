// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/geometry/pose2.h"
#include "mapbuilder/placement/pose_graph.h"
#include "mapbuilder/self_calibration/camera_adjustment.h"

namespace floorloc {

/// Unknowns of a frame's own tilt: roll and pitch (rad), relative height.
constexpr int kTiltUnknowns = 3;

/// Observation of a floor point in a frame, with its Jacobians with respect to the camera and to the frame's own tilt.
struct Observation {
  int frame = 0;
  Eigen::Vector2d point_in_base_m = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, kCameraUnknowns> by_camera = Eigen::Matrix<double, 2, kCameraUnknowns>::Zero();
  Eigen::Matrix<double, 2, 3> by_tilt = Eigen::Matrix<double, 2, 3>::Zero();  ///< roll and pitch (rad), relative height
};

/// Observations of one unknown floor point.
struct ObservedTrack {
  std::vector<Observation> observations;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< map frame
};

/// Observation of a floor point whose map position was surveyed.
struct ObservedControlPoint {
  Observation observation;
  Eigen::Vector2d point_in_map_m = Eigen::Vector2d::Zero();
  double sigma_m = 1e-3;
};

/// Observations of two floor points whose distance was measured.
struct ObservedDistance {
  Observation first;
  Observation second;
  double distance_m = 0.0;
  double sigma_m = 1e-3;
};

/// Standard deviations of a camera's unknowns, as in CameraAdjustment; 0: known exactly.
using CameraPriors = std::array<double, kCameraUnknowns>;

/// Standard deviations of the priors; 0: known exactly.
struct BundlePriors {
  std::vector<CameraPriors> cameras;
  double tilt_rad = 0.0;     ///< of a frame's own roll and pitch: vibration
  double tilt_height = 0.0;  ///< of a frame's own relative height
};

/// Unknowns and measurements of the adjustment.
struct Bundle {
  std::vector<Pose2> map_from_base;
  std::vector<int> camera_of_frame;
  std::vector<CameraAdjustment> cameras;  ///< result: one per camera, starts at zero
  /// Per camera, what earlier rounds changed already; empty: nothing. The prior is on this and `cameras` together, for
  /// it is the given calibration that it speaks of.
  std::vector<CameraAdjustment> earlier_change;
  std::vector<Eigen::Vector3d> tilts;  ///< result: one per frame, starts at zero
  std::vector<ObservedTrack> tracks;
  std::vector<ObservedControlPoint> control_points;
  std::vector<ObservedDistance> distances;
  std::vector<PosePriorFactor> priors;
  std::vector<int> fixed;               ///< frames held constant
  double observation_sigma_m = 2.5e-4;  ///< of a keypoint's coordinates
  BundlePriors prior;
};

struct BundleSummary {
  bool converged = false;
  double rms_before_m = 0.0;  ///< of the distances of observations from the mean of their track
  double rms_after_m = 0.0;
  std::vector<CameraCovariance> camera_covariance;  ///< of `cameras`; zero for unknowns that are held constant
};

/// Adjusts poses, floor points, cameras and tilts jointly (bundle adjustment; Triggs et al. 2000) under a Cauchy loss,
/// eliminating floor points first. Linearised in cameras and tilts: for large changes, rebuild the observations and
/// iterate.
BundleSummary AdjustBundle(Bundle* bundle);

}  // namespace floorloc
