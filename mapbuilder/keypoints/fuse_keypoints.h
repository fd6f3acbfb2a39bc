// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/map/floor_map.h"
#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/coverage/coverage.h"
#include "mapbuilder/keypoints/keypoint_tracks.h"
#include "mapbuilder/keypoints/prune_keypoints.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

struct KeypointFusionOptions {
  TrackOptions tracks;
  PruningOptions pruning;
  int min_coverage = 3;            ///< points that this many frames cover need two observations
  int min_frames_gone = 3;         ///< frames that must cover an unobserved point of the base map to remove it,
  double gone_probability = 0.05;  ///< if the probability of that for an existing point is below this
  RunOptions run;
  std::uint32_t seed = 1;

  KeypointFusionOptions ForCamera(const FloorPlane& floor, int keypoints_per_frame) const;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Input of the fusion. Frame i is at map_from_base[i] (empty: not used) and covers floor_in_base[i].
struct KeypointFusionInput {
  const std::vector<BuildFrame>& frames;
  const std::vector<std::optional<Pose2>>& map_from_base;
  const std::vector<RectM>& floor_in_base;
  /// Keypoints of the map being extended: from the same extractor, in the map frame (to within the tracks' radius).
  const MapKeypoints* base_map = nullptr;
  /// Floor covered by the base map's frames, for the repeat rates of its points; without it they are assumed to repeat
  /// like new points of the same response.
  const CoverageGrid* base_coverage = nullptr;
  /// Index in the map of the frames' survey 0, i.e. the number of surveys in the base map.
  int first_survey = 0;
};

/// Fuses the keypoints of overlapping frames into map points: robust mean of positions, mean of angles, majority
/// (binary) or mean (float) of descriptors, number of observations. Drops points that are unlikely to exist and keeps
/// the most useful of the others within the budget, evenly spread over the floor.
///
/// With a base map, the result is the whole new one:
/// - A re-observed point is updated: observations added, position and angle averaged by their numbers,
///   last_survey set. The old descriptor has two votes against one of each new view, so that it follows wear.
/// - A point that enough frames cover and none observes, against its repeat rate, is removed.
/// - A point that no frame covers is unchanged and does not count against the budget.
/// - New points compete with old ones in view for the budget of the floor that the frames cover.
/// Distinctiveness is recomputed for all points.
MapKeypoints FuseKeypoints(const KeypointFusionInput& in_map, const KeypointFusionOptions& options);

}  // namespace floorloc
