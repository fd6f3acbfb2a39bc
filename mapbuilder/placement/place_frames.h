// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapbuilder/placement/pair_registration.h"
#include "mapbuilder/placement/pose_graph.h"
#include "mapbuilder/survey/survey_frames.h"

namespace floorloc {

struct PlacementOptions {
  PairRegistrationOptions registration;
  bool keep_all = false;  ///< keep parts of the survey that no links connect to the largest one
  double prior_sigma_m = 0.05;
  double prior_sigma_rad = 0.05;
  /// A map without odometry or poses of which a larger share of the overlaps does not match is folded onto itself and
  /// refused. ae7b5b9; the surveys without odometry of the mapbuilder's tests.
  double max_unmatched_share = 0.15;

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// Where the frames of a build are.
struct Placement {
  std::vector<std::optional<Pose2>> map_from_base;  ///< empty: dropped
  std::vector<std::string> drop_reason;             ///< per frame; empty when placed
  std::vector<Link> links;                          ///< that the poses agree with
  int rejected_links = 0;                           ///< that they contradict
  std::vector<int> part_sizes;                      ///< frames of each part that links connect, largest first
  int overlapping_pairs = 0;                        ///< pairs of placed frames that share most of their floor
  int unmatched_pairs = 0;  ///< those of them whose images do not match: many mean a map folded onto itself
  double rms_sigma = 0.0;   ///< of the links, standard deviations
  double rms_m = 0.0;       ///< keypoint residual of the links
  double drift_m = 0.0;     ///< largest drift of odometry from the result; 0 without odometry
  double drift_rad = 0.0;
};

/// Finds overlaps, registers them and optimises all poses: SelectPairs, RegisterPairs, OptimizePoses in rounds, so that
/// drift is removed before it grows beyond what the search for overlaps allows.
Placement PlaceFrames(const std::vector<BuildFrame>& frames, const std::vector<LoadedSurvey>& surveys,
                      const PlacementOptions& options);

}  // namespace floorloc
