// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/registration/registration.h"

namespace floorloc {

/// A cell of the vote with its neighbours, and the matches that voted there.
struct VotePeak {
  int votes = 0;
  std::vector<int> matches;  ///< indices, increasing
};

/// Votes of all matches over (x, y, yaw); each match votes for the position of `source_center` in the target frame (the
/// mean of the source points, so that errors of keypoint angles have the shortest lever arm). Returns the best peaks,
/// no two of them in adjacent cells, most votes first.
std::vector<VotePeak> FindVotePeaks(const std::vector<OrientedMatch>& matches, const Eigen::Vector2d& source_center,
                                    const RegistrationOptions& options);

}  // namespace floorloc
