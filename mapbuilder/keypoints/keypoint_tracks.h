// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "core/map/floor_map.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

/// Criteria for views in different frames to be of one floor point. Lengths are for the sample camera (0.7 mm per
/// pixel).
struct TrackOptions {
  double radius_m = 1.2e-3;        ///< maximum distance of a view from the mean
  double angle_rad = 0.35;         ///< maximum difference of angles
  double max_binary_share = 0.22;  ///< maximum share of differing bits
  double max_float_share = 0.55;   ///< maximum distance of descriptors, share of their norm
  int min_views = 1;               ///< shorter tracks are dropped

  TrackOptions ForCamera(const FloorPlane& floor) const;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Views of one floor point.
struct KeypointTrack {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< mean of the views, map frame
  std::vector<std::pair<int, int>> views;                ///< (frame, keypoint), ascending, one per frame
};

/// Finds keypoints of the placed frames that are views of one floor point. Greedy: frame by frame, each keypoint joins
/// the nearby track whose first view is most similar, most similar pairs first, or starts a new one. Every keypoint of
/// a placed frame is in exactly one track before min_views applies. Time (0.3 microseconds per view) and memory (about
/// 60 bytes per view, tracks included) are linear in the views. Deterministic.
std::vector<KeypointTrack> FindTracks(const std::vector<BuildFrame>& frames,
                                      const std::vector<std::optional<Pose2>>& map_from_base,
                                      const TrackOptions& options);

/// The same, with the keypoints of an existing map as initial tracks: the first seeds.size() tracks returned are
/// theirs, in order, possibly without views; min_views does not apply to them.
std::vector<KeypointTrack> FindTracks(const std::vector<BuildFrame>& frames,
                                      const std::vector<std::optional<Pose2>>& map_from_base,
                                      const TrackOptions& options, const MapKeypoints& seeds);

}  // namespace floorloc
