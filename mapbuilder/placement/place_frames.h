// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapbuilder/placement/absolute_constraints.h"
#include "mapbuilder/placement/known_points.h"
#include "mapbuilder/placement/pair_registration.h"
#include "mapbuilder/placement/pose_graph.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

struct PlacementOptions {
  PairRegistrationOptions registration;
  bool keep_all = false;  ///< also keep parts of the survey without links to the largest one
  double prior_sigma_m = 0.05;
  double prior_sigma_rad = 0.05;
  /// A map without odometry or poses in which a larger share of the overlaps does not match is folded onto itself and
  /// rejected. Chosen at ae7b5b9 on the mapbuilder tests' surveys without odometry.
  double max_unmatched_share = 0.15;
  KnownPointOptions known_points;
  /// Largest distance of a frame from the origin of the map frame. UTM needs 1e7 m, which is also what readers of maps
  /// allow (kMaxMapCoordinateM): not quite that, for the frame's floor.
  double max_distance_m = 9.999e6;

  /// Throws std::invalid_argument with the field's name.
  void Check() const;
};

/// Poses of the frames of a build.
struct Placement {
  std::vector<std::optional<Pose2>> map_from_base;  ///< empty: dropped
  std::vector<std::string> drop_reason;             ///< per frame; empty when placed
  std::vector<Link> links;                          ///< consistent with the poses
  int rejected_links = 0;                           ///< contradicted by the poses
  std::vector<int> part_sizes;                      ///< frames per linked part, largest first
  int overlapping_pairs = 0;                        ///< placed frames that share most of their floor
  int unmatched_pairs = 0;  ///< those whose images do not match: many indicate a map folded onto itself
  /// The floor repeats itself, and images alone told the frames' order: which of its equal places they show is a guess
  /// where few overlap.
  bool repeats_unaided = false;
  double rms_sigma = 0.0;  ///< of the links, in standard deviations
  double rms_m = 0.0;      ///< keypoint residual of the links
  double drift_m = 0.0;    ///< largest deviation of odometry from the result; 0 without odometry
  double drift_rad = 0.0;
  ControlPointFindings control_points;
};

/// Finds overlaps, registers them and optimises all poses. Selection, registration and optimisation alternate, so
/// that drift is removed before it exceeds the search radius for overlaps.
Placement PlaceFrames(const std::vector<BuildFrame>& frames, const std::vector<LoadedSurvey>& surveys,
                      const PlacementOptions& options);

}  // namespace floorloc
