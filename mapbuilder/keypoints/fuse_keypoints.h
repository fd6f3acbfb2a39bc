// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/map/floor_map.h"
#include "mapbuilder/coverage/coverage.h"
#include "mapbuilder/keypoints/keypoint_tracks.h"
#include "mapbuilder/keypoints/prune_keypoints.h"
#include "mapbuilder/survey/survey_frames.h"

namespace floorloc {

struct KeypointFusionOptions {
  TrackOptions tracks;
  PruningOptions pruning;
  int min_coverage = 3;            ///< where as many frames cover it, a point that only one observed is dropped
  int min_frames_gone = 3;         ///< frames that must cover a point of the base map in vain before it is removed,
  double gone_probability = 0.05;  ///< and this must be less likely by chance
  int threads = 0;                 ///< 0: one per core
  std::uint32_t seed = 1;

  KeypointFusionOptions ForCamera(const FloorPlane& floor, int keypoints_per_frame) const;
};

/// What is fused. Frame i is at map_from_base[i] (empty: left out) and sees floor_in_base[i].
struct KeypointFusionInput {
  const std::vector<BuildFrame>& frames;
  const std::vector<std::optional<Pose2>>& map_from_base;
  const std::vector<RectM>& floor_in_base;
  /// Keypoints of the map that the frames extend: by the same extractor, in its frame (to within the tracks' radius).
  const MapKeypoints* base_map = nullptr;
  /// Floor that the base map's frames cover, for its points' repeat rates; without it all are taken to repeat like new
  /// points of their response.
  const CoverageGrid* base_coverage = nullptr;
  /// Index in the map of the frames' survey 0: the number of surveys in the base map.
  int first_survey = 0;
};

/// Keypoints of overlapping frames become map points: positions averaged against outliers, angles averaged, descriptors
/// by majority (binary) or mean (float), the number of observations counted. Points that are unlikely to exist are
/// dropped, and of the others the most useful ones kept within the budget, evenly over the floor.
///
/// With a base map, the result is the whole new one:
/// - A re-observed point is updated: observations added, position and angle averaged by their numbers,
///   last_survey set. The old descriptor has two votes against one of each new view, so that it follows wear.
/// - One that enough frames cover and none observed, though its repeat rate makes that unlikely, is removed.
/// - One that no frame covers stays as it is, and takes nothing of the budget.
/// - New points compete with the old ones in view for the budget of the floor that the frames cover.
/// Distinctiveness is recomputed for all points.
MapKeypoints FuseKeypoints(const KeypointFusionInput& input, const KeypointFusionOptions& options);

}  // namespace floorloc
