// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace floorloc {

/// A point in two pinhole cameras, each in normalized coordinates on the plane z = 1 (x right, y down, z along the
/// optical axis).
struct PointPair {
  Eigen::Vector2d first = Eigen::Vector2d::Zero();
  Eigen::Vector2d second = Eigen::Vector2d::Zero();
};

/// Rotation without translation that fits most of the pairs.
struct RotationFit {
  Eigen::Matrix3d second_from_first = Eigen::Matrix3d::Identity();
  double parallax_rad = 0.0;  ///< median angle left between the rays, which only a translation explains
};

/// Kabsch on the rays: on all pairs, then twice on the half with the smaller residuals. At least three pairs.
RotationFit FitRotation(const std::vector<PointPair>& pairs);

/// Motion between two cameras up to the length of the translation.
struct TwoViewMotion {
  Eigen::Matrix3d second_from_first = Eigen::Matrix3d::Identity();
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< x_in_second = R * x_in_first + length * direction
  std::vector<bool> inliers;                            ///< per pair; in front of both cameras
  int inlier_count = 0;
};

/// Five-point algorithm (Nister 2004) in RANSAC, decomposed such that the points are in front of both cameras. noise:
/// of a point on the plane z = 1. Deterministic. Empty when fewer than 8 pairs agree.
std::optional<TwoViewMotion> EstimateMotion(const std::vector<PointPair>& pairs, double noise);

/// Depth (z) of a pair's point in the first camera, by the midpoint of the rays. Empty when they are within
/// min_angle_rad of being parallel or the point is behind a camera.
std::optional<double> TriangulateDepth(const PointPair& pair, const Eigen::Isometry3d& second_from_first,
                                       double min_angle_rad);

/// A landmark in the first camera's frame and its observation in the second one, on the plane z = 1.
struct LandmarkObservation {
  Eigen::Vector3d in_first = Eigen::Vector3d::Zero();
  Eigen::Vector2d in_second = Eigen::Vector2d::Zero();
};

/// Pose from landmarks: Levenberg-Marquardt on the reprojection errors with Huber's loss at `noise`, starting at the
/// guess. Empty when fewer than min_share of the landmarks end within three times the noise.
std::optional<Eigen::Isometry3d> RefinePoseByLandmarks(const std::vector<LandmarkObservation>& landmarks,
                                                       const Eigen::Isometry3d& guess, double noise, double min_share);

}  // namespace floorloc
