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

struct FusionOptions {
  TrackOptions tracks;
  PruningOptions pruning;
  int min_coverage = 3;            ///< where as many frames look, a point that one alone saw is dropped
  int min_frames_gone = 3;         ///< so many frames must look in vain before an old point can be gone,
  double gone_probability = 0.05;  ///< and that this is chance must be less likely
  int threads = 0;                 ///< 0: one per core
  std::uint32_t seed = 1;

  FusionOptions ForCamera(const FloorPlane& floor, int keypoints_per_frame) const;
};

/// What is fused. Frame i is at map_from_base[i] (empty: left out) and sees floor_in_base[i].
struct FusionInput {
  const std::vector<BuildFrame>& frames;
  const std::vector<std::optional<Pose2>>& map_from_base;
  const std::vector<RectM>& floor_in_base;
  /// Keypoints of the map that the frames extend: by the same extractor, in its frame (to within the tracks' radius).
  const MapKeypoints* old = nullptr;
  /// Where the old map's frames looked, for its points' repeat rates; without it all are taken to repeat like new
  /// points of their response.
  const CoverageGrid* old_coverage = nullptr;
  /// Index in the map of the frames' survey 0: the number of surveys in the old map.
  int first_survey = 0;
};

/// Keypoints of overlapping frames become map points: positions averaged against outliers, angles averaged, descriptors
/// by majority (binary) or mean (float), the number of observations counted. Points that are unlikely to exist are
/// dropped, and of the others the most useful ones kept within the budget, evenly over the floor.
///
/// With an old map, the result is the whole new one:
/// - An old point that frames saw again is updated: observations added, position and angle averaged by their numbers,
///   last_survey set. The old look has two votes against one of each new view, so that it follows wear.
/// - One that enough frames looked at and none saw, though its repeat rate makes that unlikely, is dropped as gone.
/// - One that no frame looked at stays as it is, and takes nothing of the budget.
/// - New points compete with the old ones in view for the budget of the floor that the frames look at.
/// Distinctiveness is measured anew for all points.
MapKeypoints FuseKeypoints(const FusionInput& input, const FusionOptions& options);

}  // namespace floorloc
