// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "core/map/floor_map.h"
#include "mapbuilder/survey/survey_frames.h"

namespace floorloc {

/// When views in different frames are of one floor point. Lengths are for the sample camera (0.7 mm per pixel).
struct TrackOptions {
  double radius_m = 1.2e-3;        ///< they lie this close to their mean
  double angle_rad = 0.35;         ///< their angles differ by no more
  double max_binary_share = 0.22;  ///< differing bits, share of all
  double max_float_share = 0.55;   ///< distance of descriptors, share of their norm
  int min_views = 1;               ///< tracks with fewer are left out

  TrackOptions ForCamera(const FloorPlane& floor) const;
};

/// One floor point as the frames saw it.
struct KeypointTrack {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< mean of the views, map frame
  std::vector<std::pair<int, int>> views;                ///< frame, keypoint; in the order of the frames, each once
};

/// Finds which keypoints of the placed frames are views of one floor point. Greedy: frame after frame, each keypoint
/// joins the track nearby whose first view is most similar, most similar pairs first, or starts one. Every keypoint of
/// a placed frame is in exactly one track (of any number of views). Time is linear in the views (0.3 microseconds
/// each), and so is memory (some 60 bytes each, the tracks included). The same input gives the same tracks.
std::vector<KeypointTrack> FindTracks(const std::vector<BuildFrame>& frames,
                                      const std::vector<std::optional<Pose2>>& map_from_base,
                                      const TrackOptions& options);

/// The same, with the keypoints of an existing map as tracks to join: the first seeds.size() tracks returned are
/// theirs, in order, some without views; min_views does not apply to them.
std::vector<KeypointTrack> FindTracks(const std::vector<BuildFrame>& frames,
                                      const std::vector<std::optional<Pose2>>& map_from_base,
                                      const TrackOptions& options, const MapKeypoints& seeds);

}  // namespace floorloc
