// SPDX-License-Identifier: Apache-2.0
#include "core/vision/guided_matcher.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace floorloc {
namespace {

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

// What a keypoint must agree with to be a candidate.
struct GuidedMatcher::Window {
  Eigen::Vector2d center;
  double radius_m;
  Eigen::Vector2f direction;  // unit vector of the predicted angle
  float min_cos;              // of the angle between it and a candidate's
  float size_m;

  bool Accepts(const Entry& e) const {
    const float dx = e.x_m - static_cast<float>(center.x());
    const float dy = e.y_m - static_cast<float>(center.y());
    const auto radius = static_cast<float>(radius_m);
    return dx * dx + dy * dy <= radius * radius &&
           direction.x() * e.cos_angle + direction.y() * e.sin_angle >= min_cos && e.size_m < kMaxSizeRatio * size_m &&
           size_m < kMaxSizeRatio * e.size_m;
  }
};

GuidedMatcher::GuidedMatcher(const std::vector<Keypoint>& keypoints, const cv::Mat& descriptors, double cell_m)
    : descriptors_(descriptors), cell_m_(cell_m) {
  if (descriptors.depth() == CV_8U) {
    packed_ = PackedDescriptors(descriptors);
  }
  if (keypoints.empty()) {
    return;
  }
  Eigen::Vector2d low = keypoints.front().Position();
  Eigen::Vector2d high = low;
  for (const Keypoint& k : keypoints) {
    low = low.cwiseMin(k.Position());
    high = high.cwiseMax(k.Position());
  }
  origin_ = low;
  // However far apart the keypoints of a strange map lie, the grid stays in proportion to their number.
  const double max_cells = std::max(1e5, 64.0 * static_cast<double>(keypoints.size()));
  const Eigen::Vector2d extent = high - low;
  while ((extent.x() / cell_m_ + 1.0) * (extent.y() / cell_m_ + 1.0) > max_cells) {
    cell_m_ *= 2.0;
  }
  columns_ = static_cast<int>(extent.x() / cell_m_) + 1;
  rows_ = static_cast<int>(extent.y() / cell_m_) + 1;
  const auto cell_of = [&](const Keypoint& k) {
    const Eigen::Vector2d p = (k.Position() - origin_) / cell_m_;
    return static_cast<std::size_t>(p.y()) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(p.x());
  };
  cell_start_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
  for (const Keypoint& k : keypoints) {
    ++cell_start_[cell_of(k) + 1];
  }
  for (std::size_t c = 1; c < cell_start_.size(); ++c) {
    cell_start_[c] += cell_start_[c - 1];
  }
  entries_.resize(keypoints.size());
  std::vector<int> next(cell_start_.begin(), cell_start_.end() - 1);
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const Keypoint& k = keypoints[i];
    entries_[static_cast<std::size_t>(next[cell_of(k)]++)] = {
        k.x_m, k.y_m, std::cos(k.angle_rad), std::sin(k.angle_rad), k.size_m, static_cast<int>(i)};
  }
}

void GuidedMatcher::Collect(const Window& window, std::vector<int>* candidates) const {
  candidates->clear();
  const Eigen::Vector2d low = (window.center.array() - window.radius_m - origin_.array()) / cell_m_;
  const Eigen::Vector2d high = (window.center.array() + window.radius_m - origin_.array()) / cell_m_;
  // Compared as doubles: a wild prior must not overflow an int.
  if (!(low.x() < columns_ && low.y() < rows_ && high.x() >= 0.0 && high.y() >= 0.0)) {
    return;
  }
  const int first_column = static_cast<int>(std::max(low.x(), 0.0));
  const int last_column = static_cast<int>(std::min(high.x(), columns_ - 1.0));
  const int first_row = static_cast<int>(std::max(low.y(), 0.0));
  const int last_row = static_cast<int>(std::min(high.y(), rows_ - 1.0));
  for (int row = first_row; row <= last_row; ++row) {
    const auto first = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
    const Entry* entry = entries_.data() + cell_start_[first + static_cast<std::size_t>(first_column)];
    const Entry* end = entries_.data() + cell_start_[first + static_cast<std::size_t>(last_column) + 1];
    for (; entry != end; ++entry) {
      if (window.Accepts(*entry)) {
        candidates->push_back(entry->index);
      }
    }
  }
}

Match GuidedMatcher::FindAmong(const Features& query, const PackedDescriptors& packed_query, int row,
                               const std::vector<int>& candidates) const {
  if (packed_.rows() == 0) {
    return NearestEuclidean(query.descriptors, row, descriptors_, candidates);
  }
  const TwoNearest best = FindTwoNearest(packed_, packed_query.row(row), candidates);
  const float second =
      best.second_index >= 0 ? static_cast<float>(best.second_distance) : std::numeric_limits<float>::infinity();
  return {row, best.index, static_cast<float>(best.distance), second};
}

std::vector<Match> GuidedMatcher::FindNearest(const Features& query, const MatchGuide& guide) const {
  const PackedDescriptors packed_query =
      packed_.rows() > 0 ? PackedDescriptors(query.descriptors) : PackedDescriptors();
  const double yaw = guide.target_from_query.yaw();
  const auto min_cos = static_cast<float>(std::cos(std::min(guide.yaw_radius_rad, std::numbers::pi)));
  std::vector<Match> matches;
  std::vector<int> candidates;
  for (std::size_t i = 0; i < query.keypoints.size(); i += static_cast<std::size_t>(guide.stride)) {
    const Keypoint& k = query.keypoints[i];
    const double angle = yaw + k.angle_rad;
    Collect({guide.target_from_query * k.Position(), guide.radius_m,
             Eigen::Vector2d(std::cos(angle), std::sin(angle)).cast<float>(), min_cos, k.size_m},
            &candidates);
    if (!candidates.empty()) {
      matches.push_back(FindAmong(query, packed_query, static_cast<int>(i), candidates));
    }
  }
  return matches;
}

}  // namespace floorloc
