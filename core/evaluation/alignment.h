// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "core/evaluation/association.h"

namespace floorloc {

/// How the estimate is aligned before it is compared.
enum class AlignmentMode {
  kNone,    ///< none: both trajectories are in the same frame
  kSe2,     ///< rotation and translation in the plane
  kSe3,     ///< rotation and translation in space
  kSim3,    ///< rotation, translation and scale in space
  kScale,   ///< scale only, that of kSim3: for odometry that starts at the reference's first pose
  kOrigin,  ///< the first poses are made equal
};

/// x_in_reference = scale * rotation * x_in_estimate + translation, metres.
struct Similarity3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();
  double scale = 1.0;

  StampedPose3 operator*(const StampedPose3& pose) const;
};

/// The transformation of the estimated positions to the reference positions by least squares (Umeyama 1991), or of the
/// first estimated pose to its reference (kOrigin). Throws std::invalid_argument when the positions do not determine
/// it, e.g. when they are collinear in space.
Similarity3 ComputeAlignment(const std::vector<PosePair>& pairs, AlignmentMode mode);

/// The pairs with transformed estimates.
std::vector<PosePair> Align(std::vector<PosePair> pairs, const Similarity3& reference_from_estimate);

}  // namespace floorloc
