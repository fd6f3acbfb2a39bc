// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "core/evaluation/association.h"

namespace floorloc {

/// How the estimate is aligned before it is compared.
enum class AlignmentMode {
  kNone,    ///< not at all: both trajectories live in the same frame
  kSe2,     ///< turned and shifted in the plane
  kSe3,     ///< turned and shifted in space
  kSim3,    ///< turned, shifted and scaled in space
  kScale,   ///< scaled only, by the scale that kSim3 would find: odometry that starts where the reference does
  kOrigin,  ///< so that the first poses agree
};

/// x_in_reference = scale * rotation * x_in_estimate + translation, metres.
struct Similarity3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();
  double scale = 1.0;

  StampedPose3 operator*(const StampedPose3& pose) const;
};

/// The motion that brings the estimated positions closest to the reference positions in the least-squares sense
/// (Umeyama 1991), or the first estimated pose onto its reference (kOrigin). Throws std::invalid_argument when the
/// positions do not determine it, e.g. when all lie on a line and space, not the plane, is asked for.
Similarity3 ComputeAlignment(const std::vector<PosePair>& pairs, AlignmentMode mode);

/// The pairs with their estimates moved.
std::vector<PosePair> Align(std::vector<PosePair> pairs, const Similarity3& reference_from_estimate);

}  // namespace floorloc
