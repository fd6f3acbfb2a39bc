// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "core/map/floor_map.h"
#include "mapbuilder/keypoints/descriptor_vote.h"
#include "mapbuilder/keypoints/keypoint_tracks.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

/// A map point without its descriptor.
struct FusedPoint {
  Keypoint keypoint;
  int observations = 0;
};

/// An observed position with its weight.
struct WeightedPosition {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double weight = 1.0;
};

/// Weighted mean with Huber weights (iteratively reweighted least squares): positions farther than `huber_m` from the
/// mean get weights inversely proportional to their distance.
Eigen::Vector2d RobustMean(const std::vector<WeightedPosition>& positions, double huber_m);

/// Fuses the views of a track into one map point, together with the old point if the track belongs to one of the base
/// map.
class TrackFuser {
 public:
  /// like: any matrix of the descriptors' type. huber_m: typical distance of a view from its point.
  TrackFuser(const std::vector<BuildFrame>& frames, const std::vector<std::optional<Pose2>>& map_from_base,
             const cv::Mat& like, double huber_m);

  /// Writes the fused descriptor to the row. The track must have at least one view.
  FusedPoint Fuse(const KeypointTrack& track, cv::Mat* descriptors, int row);
  /// The same, updating a point of the base map.
  FusedPoint Update(const MapKeypoints& base_map, int index, const KeypointTrack& track, cv::Mat* descriptors, int row);

 private:
  void Start();
  void AddViews(const KeypointTrack& track);
  FusedPoint Finish(cv::Mat* descriptors, int row);
  void AddKeypoint(const Keypoint& in_map, int count);

  const std::vector<BuildFrame>& frames_;
  const std::vector<std::optional<Pose2>>& map_from_base_;
  double huber_m_;
  DescriptorVote vote_;
  std::vector<WeightedPosition> positions_;
  Eigen::Vector2d angle_sum_ = Eigen::Vector2d::Zero();  // of unit vectors
  double size_sum_ = 0.0;
  double response_sum_ = 0.0;
  int count_ = 0;
};

}  // namespace floorloc
