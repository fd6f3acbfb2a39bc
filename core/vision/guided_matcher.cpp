// SPDX-License-Identifier: Apache-2.0
#include "core/vision/guided_matcher.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace floorloc {
namespace {

bool SizesAgree(float a, float b) { return a < kMaxSizeRatio * b && b < kMaxSizeRatio * a; }

float Euclidean(const cv::Mat& a, int row_a, const cv::Mat& b, int row_b) {
  const float* x = a.ptr<float>(row_a);
  const float* y = b.ptr<float>(row_b);
  float sum = 0.0F;
  for (int i = 0; i < a.cols; ++i) {
    sum += (x[i] - y[i]) * (x[i] - y[i]);
  }
  return std::sqrt(sum);
}

// The nearest and second nearest of float descriptors, among a few.
Match NearestEuclidean(const cv::Mat& query, int row, const cv::Mat& train, const std::vector<int>& candidates) {
  Match best{row, -1, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity()};
  for (const int i : candidates) {
    const float distance = Euclidean(query, row, train, i);
    if (distance < best.distance) {
      best.second_distance = best.distance;
      best.distance = distance;
      best.train = i;
    } else {
      best.second_distance = std::min(best.second_distance, distance);
    }
  }
  return best;
}

}  // namespace

GuidedMatcher::GuidedMatcher(const std::vector<Keypoint>& keypoints, const cv::Mat& descriptors, double cell_m)
    : keypoints_(keypoints), descriptors_(descriptors), cell_m_(cell_m) {
  if (descriptors.depth() == CV_8U) {
    packed_ = PackedDescriptors(descriptors);
  }
  if (keypoints.empty()) {
    cell_start_.assign(1, 0);
    return;
  }
  Eigen::Vector2d low = keypoints.front().Position();
  Eigen::Vector2d high = low;
  for (const Keypoint& k : keypoints) {
    low = low.cwiseMin(k.Position());
    high = high.cwiseMax(k.Position());
  }
  origin_ = low;
  columns_ = static_cast<int>((high.x() - low.x()) / cell_m) + 1;
  rows_ = static_cast<int>((high.y() - low.y()) / cell_m) + 1;
  const auto cell_of = [&](const Keypoint& k) {
    const Eigen::Vector2d p = (k.Position() - origin_) / cell_m_;
    return static_cast<std::size_t>(static_cast<int>(p.y()) * columns_ + static_cast<int>(p.x()));
  };
  cell_start_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
  for (const Keypoint& k : keypoints) {
    ++cell_start_[cell_of(k) + 1];
  }
  for (std::size_t c = 1; c < cell_start_.size(); ++c) {
    cell_start_[c] += cell_start_[c - 1];
  }
  sorted_.resize(keypoints.size());
  std::vector<int> next(cell_start_.begin(), cell_start_.end() - 1);
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    sorted_[static_cast<std::size_t>(next[cell_of(keypoints[i])]++)] = static_cast<int>(i);
  }
}

void GuidedMatcher::Collect(const Eigen::Vector2d& center, double radius_m, std::vector<int>* candidates) const {
  candidates->clear();
  const Eigen::Vector2d low = (center.array() - radius_m - origin_.array()) / cell_m_;
  const Eigen::Vector2d high = (center.array() + radius_m - origin_.array()) / cell_m_;
  // Compared as doubles: a wild prior must not overflow an int.
  if (!(low.x() < columns_ && low.y() < rows_ && high.x() >= 0.0 && high.y() >= 0.0)) {
    return;
  }
  const int first_column = static_cast<int>(std::max(low.x(), 0.0));
  const int last_column = static_cast<int>(std::min(high.x(), columns_ - 1.0));
  const int first_row = static_cast<int>(std::max(low.y(), 0.0));
  const int last_row = static_cast<int>(std::min(high.y(), rows_ - 1.0));
  for (int row = first_row; row <= last_row; ++row) {
    const auto first = static_cast<std::size_t>(row * columns_ + first_column);
    const auto last = static_cast<std::size_t>(row * columns_ + last_column);
    candidates->insert(candidates->end(), sorted_.begin() + cell_start_[first], sorted_.begin() + cell_start_[last + 1]);
  }
}

std::vector<Match> GuidedMatcher::FindNearest(const Features& query, const MatchGuide& guide) const {
  const PackedDescriptors packed_query =
      packed_.rows() > 0 ? PackedDescriptors(query.descriptors) : PackedDescriptors();
  std::vector<Match> matches;
  std::vector<int> candidates;
  for (std::size_t i = 0; i < query.keypoints.size(); ++i) {
    const Keypoint& k = query.keypoints[i];
    const Eigen::Vector2d place = guide.target_from_query * k.Position();
    const double angle = guide.target_from_query.yaw() + k.angle_rad;
    Collect(place, guide.radius_m, &candidates);
    std::erase_if(candidates, [&](int c) {
      const Keypoint& candidate = keypoints_[static_cast<std::size_t>(c)];
      return (candidate.Position() - place).squaredNorm() > guide.radius_m * guide.radius_m ||
             std::abs(WrapAngle(candidate.angle_rad - angle)) > guide.yaw_radius_rad ||
             !SizesAgree(candidate.size_m, k.size_m);
    });
    if (candidates.empty()) {
      continue;
    }
    const int row = static_cast<int>(i);
    if (packed_.rows() == 0) {
      matches.push_back(NearestEuclidean(query.descriptors, row, descriptors_, candidates));
      continue;
    }
    const TwoNearest best = FindTwoNearest(packed_, packed_query.row(row), candidates);
    const float second = best.second_index >= 0 ? static_cast<float>(best.second_distance)
                                                : std::numeric_limits<float>::infinity();
    matches.push_back({row, best.index, static_cast<float>(best.distance), second});
  }
  return matches;
}

}  // namespace floorloc
