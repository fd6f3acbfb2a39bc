// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/vision/descriptor_index.h"
#include "core/vision/features.h"
#include "core/vision/hamming.h"

namespace floorloc {

/// Where a query frame is thought to be in the frame of the matcher's keypoints.
struct MatchGuide {
  Pose2 target_from_query;
  double radius_m = 0.1;        ///< how far a keypoint may lie from its predicted place
  double yaw_radius_rad = 0.3;  ///< how far its angle may be from the predicted one
};

/// Largest ratio of sizes between two views of one keypoint: the floor's scale is known.
constexpr float kMaxSizeRatio = 1.5F;

/// Matches a frame to keypoints near their predicted places only, through a spatial grid. Refers to the keypoints and
/// descriptors, which must outlive it. Const and thread-safe.
class GuidedMatcher {
 public:
  GuidedMatcher(const std::vector<Keypoint>& keypoints, const cv::Mat& descriptors, double cell_m);

  /// One match per query keypoint that has a candidate.
  std::vector<Match> FindNearest(const Features& query, const MatchGuide& guide) const;

 private:
  void Collect(const Eigen::Vector2d& center, double radius_m, std::vector<int>* candidates) const;

  const std::vector<Keypoint>& keypoints_;
  const cv::Mat& descriptors_;
  PackedDescriptors packed_;  // empty for float descriptors
  double cell_m_;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int columns_ = 0;
  int rows_ = 0;
  std::vector<int> cell_start_;  // keypoints of cell c: sorted_[cell_start_[c] .. cell_start_[c + 1])
  std::vector<int> sorted_;
};

}  // namespace floorloc
