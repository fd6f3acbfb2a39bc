// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/vision/features/features.h"
#include "core/vision/matching/descriptor_index.h"
#include "core/vision/matching/hamming.h"

namespace floorloc {

/// Predicted pose of a query frame in the frame of the matcher's keypoints.
struct MatchGuide {
  Pose2 target_from_query;
  double radius_m = 0.1;        ///< largest distance of a keypoint from its predicted position
  double yaw_radius_rad = 0.3;  ///< largest difference of its angle from the predicted one
  int stride = 1;               ///< only every stride-th query keypoint is matched
  /// The query's descriptors are upright, at the heading of target_from_query: they are compared with the upright ones,
  /// whatever the keypoints' own angles.
  bool upright = false;
};

/// Largest ratio of sizes between two views of one keypoint: the floor's scale is known.
constexpr float kMaxSizeRatio = 1.5F;

/// Tolerance of a keypoint's angle between two views.
constexpr double kKeypointAngleNoiseRad = 0.35;

/// Matches keypoints of a frame only to keypoints near their predicted positions, by a spatial grid. Refers to float
/// descriptors, which must outlive it. Const and thread-safe.
class GuidedMatcher {
 public:
  /// cell_m: side of the grid's cells, > 0. upright: binary descriptors of the same keypoints, or empty. Throws
  /// std::invalid_argument when the cell is not a positive number, or when the numbers of keypoints and upright
  /// descriptors differ.
  GuidedMatcher(const std::vector<Keypoint>& keypoints, const cv::Mat& descriptors, double cell_m,
                const cv::Mat& upright = cv::Mat());

  /// One match per query keypoint that has a candidate. Throws std::invalid_argument when the descriptors differ from
  /// its own (the upright ones, as the guide says) in type or length, or when the stride is below 1.
  std::vector<Match> FindNearest(const Features& query, const MatchGuide& guide) const;

  /// Indices of the keypoints of similar size (kMaxSizeRatio) within radius_m of a keypoint, at any angle, including
  /// itself.
  std::vector<int> FindWithin(const Keypoint& keypoint, double radius_m) const;

 private:
  // The keypoints sorted by grid cell, one array per field (structure of arrays) for vectorized tests.
  struct Entries {
    std::vector<float> x_m, y_m, cos_angle, sin_angle, size_m;
    std::vector<int> index;  // in the keypoints
  };
  struct Window;
  struct PackedQuery;  // binary descriptors of a query, and those that they are compared with

  void CollectRun(const Window& window, int begin, int end, std::vector<int>* candidates) const;
  void Collect(const Window& window, std::vector<int>* candidates) const;
  Match FindAmong(const Features& query, const PackedQuery& packed, int row, const std::vector<int>& candidates) const;

  cv::Mat descriptors_;       // as given; used for float descriptors
  PackedDescriptors packed_;  // binary descriptors, as given
  cv::Mat upright_descriptors_;
  PackedDescriptors upright_;
  double cell_m_;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int columns_ = 0;
  int rows_ = 0;
  std::vector<int> cell_start_;  // entries of cell c: entries_[cell_start_[c] .. cell_start_[c + 1])
  Entries entries_;
};

}  // namespace floorloc
