// SPDX-License-Identifier: Apache-2.0
#include "core/vision/matching/guided_matcher.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "core/vision/features/descriptor_layout.h"
#include "core/vision/image/multiversion.h"

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

// Nearest and second nearest float descriptor among the candidates.
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

// As the least cosine: every angle is near enough.
constexpr float kAnyAngle = -2.0F;

// Fields of a run of keypoints.
struct RunFields {
  const float* x_m;
  const float* y_m;
  const float* cos_angle;
  const float* sin_angle;
  const float* size_m;
};

// The window as plain numbers, for the vectorized loop over keypoints.
struct WindowLimits {
  float x_m, y_m, squared_radius, cos_angle, sin_angle, min_cos, min_size_m, max_size_m;
};

FLOORLOC_WIDE_VECTORS
void TestRun(const RunFields& run, const WindowLimits& w, int count, std::int32_t* __restrict accepted) {
  const float* __restrict x = run.x_m;
  const float* __restrict y = run.y_m;
  const float* __restrict c = run.cos_angle;
  const float* __restrict s = run.sin_angle;
  const float* __restrict size = run.size_m;
  for (int i = 0; i < count; ++i) {
    const float dx = x[i] - w.x_m;
    const float dy = y[i] - w.y_m;
    const auto near = static_cast<std::int32_t>(dx * dx + dy * dy <= w.squared_radius);
    const auto turned = static_cast<std::int32_t>(w.cos_angle * c[i] + w.sin_angle * s[i] >= w.min_cos);
    const auto large = static_cast<std::int32_t>(size[i] > w.min_size_m);
    const auto small = static_cast<std::int32_t>(size[i] < w.max_size_m);
    accepted[i] = near & turned & large & small;
  }
}

}  // namespace

// Conditions on a candidate keypoint.
struct GuidedMatcher::Window {
  float x_m, y_m;
  float radius_m;
  float cos_angle, sin_angle;  // of the predicted angle
  float min_cos;               // least cosine of the angle between it and a candidate's
  float size_m;
};

struct GuidedMatcher::PackedQuery {
  PackedDescriptors query;
  const PackedDescriptors* train = nullptr;
};

GuidedMatcher::GuidedMatcher(const std::vector<Keypoint>& keypoints, const cv::Mat& descriptors, double cell_m,
                             const cv::Mat& upright)
    : descriptors_(descriptors), upright_descriptors_(upright), cell_m_(cell_m) {
  if (!(cell_m > 0.0) || !std::isfinite(cell_m)) {
    throw std::invalid_argument("cell_m must be a positive number");
  }
  if (descriptors.depth() == CV_8U) {
    packed_ = PackedDescriptors(descriptors);
  }
  if (!upright.empty()) {
    if (static_cast<std::size_t>(upright.rows) != keypoints.size() || upright.type() != CV_8UC1) {
      throw std::invalid_argument("there must be as many upright descriptors, of bytes, as keypoints");
    }
    upright_ = PackedDescriptors(upright);
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
  // Bounds the grid by the number of keypoints, whatever the extent of a damaged map.
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
  for (std::vector<float>* field :
       {&entries_.x_m, &entries_.y_m, &entries_.cos_angle, &entries_.sin_angle, &entries_.size_m}) {
    field->resize(keypoints.size());
  }
  entries_.index.resize(keypoints.size());
  std::vector<int> next(cell_start_.begin(), cell_start_.end() - 1);
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const Keypoint& k = keypoints[i];
    const auto place = static_cast<std::size_t>(next[cell_of(k)]++);
    entries_.x_m[place] = k.x_m;
    entries_.y_m[place] = k.y_m;
    entries_.cos_angle[place] = std::cos(k.angle_rad);
    entries_.sin_angle[place] = std::sin(k.angle_rad);
    entries_.size_m[place] = k.size_m;
    entries_.index[place] = static_cast<int>(i);
  }
}

void GuidedMatcher::CollectRun(const Window& window, int begin, int end, std::vector<int>* candidates) const {
  constexpr int kBlock = 256;
  std::array<std::int32_t, kBlock> accepted{};
  const WindowLimits limits{
      window.x_m,       window.y_m,     window.radius_m * window.radius_m, window.cos_angle,
      window.sin_angle, window.min_cos, window.size_m / kMaxSizeRatio,     kMaxSizeRatio * window.size_m};
  for (int first = begin; first < end; first += kBlock) {
    const int count = std::min(kBlock, end - first);
    TestRun({&entries_.x_m[static_cast<std::size_t>(first)], &entries_.y_m[static_cast<std::size_t>(first)],
             &entries_.cos_angle[static_cast<std::size_t>(first)], &entries_.sin_angle[static_cast<std::size_t>(first)],
             &entries_.size_m[static_cast<std::size_t>(first)]},
            limits, count, accepted.data());
    // Branch-free: acceptance is unpredictable.
    std::size_t size = candidates->size();
    candidates->resize(size + static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
      (*candidates)[size] = entries_.index[static_cast<std::size_t>(first) + static_cast<std::size_t>(i)];
      size += static_cast<std::size_t>(accepted[static_cast<std::size_t>(i)]);
    }
    candidates->resize(size);
  }
}

void GuidedMatcher::Collect(const Window& window, std::vector<int>* candidates) const {
  candidates->clear();
  const Eigen::Vector2d center(static_cast<double>(window.x_m), static_cast<double>(window.y_m));
  const auto radius_m = static_cast<double>(window.radius_m);
  const Eigen::Vector2d low = (center.array() - radius_m - origin_.array()) / cell_m_;
  const Eigen::Vector2d high = (center.array() + radius_m - origin_.array()) / cell_m_;
  // Compared as doubles: an extreme prior must not overflow an int.
  if (!(low.x() < columns_ && low.y() < rows_ && high.x() >= 0.0 && high.y() >= 0.0)) {
    return;
  }
  const int first_column = static_cast<int>(std::max(low.x(), 0.0));
  const int last_column = static_cast<int>(std::min(high.x(), columns_ - 1.0));
  const int first_row = static_cast<int>(std::max(low.y(), 0.0));
  const int last_row = static_cast<int>(std::min(high.y(), rows_ - 1.0));
  for (int row = first_row; row <= last_row; ++row) {
    const auto first = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
    CollectRun(window, cell_start_[first + static_cast<std::size_t>(first_column)],
               cell_start_[first + static_cast<std::size_t>(last_column) + 1], candidates);
  }
}

Match GuidedMatcher::FindAmong(const Features& query, const PackedQuery& packed, int row,
                               const std::vector<int>& candidates) const {
  if (packed.train->rows() == 0) {
    return NearestEuclidean(query.descriptors, row, descriptors_, candidates);
  }
  const TwoNearest best = FindTwoNearest(*packed.train, packed.query.row(row), candidates);
  const float second =
      best.second_index >= 0 ? static_cast<float>(best.second_distance) : std::numeric_limits<float>::infinity();
  return {row, best.index, static_cast<float>(best.distance), second};
}

std::vector<int> GuidedMatcher::FindWithin(const Keypoint& keypoint, double radius_m) const {
  std::vector<int> found;
  Collect({keypoint.x_m, keypoint.y_m, static_cast<float>(radius_m), 1.0F, 0.0F, kAnyAngle, keypoint.size_m}, &found);
  return found;
}

std::vector<Match> GuidedMatcher::FindNearest(const Features& query, const MatchGuide& guide) const {
  if (guide.stride < 1) {
    throw std::invalid_argument("stride must be at least 1");
  }
  if (query.keypoints.empty() || descriptors_.rows == 0) {
    return {};
  }
  CheckComparable(query.descriptors, LayoutOf(guide.upright ? upright_descriptors_ : descriptors_));
  if (query.keypoints.size() != static_cast<std::size_t>(query.descriptors.rows)) {
    throw std::invalid_argument("a frame must have as many descriptors as keypoints");
  }
  PackedQuery packed{{}, guide.upright ? &upright_ : &packed_};
  if (packed.train->rows() > 0) {
    packed.query = PackedDescriptors(query.descriptors);
  }
  const double yaw = guide.target_from_query.yaw();
  const float min_cos =
      guide.upright ? kAnyAngle : static_cast<float>(std::cos(std::min(guide.yaw_radius_rad, std::numbers::pi)));
  std::vector<Match> matches;
  std::vector<int> candidates;
  for (std::size_t i = 0; i < query.keypoints.size(); i += static_cast<std::size_t>(guide.stride)) {
    const Keypoint& k = query.keypoints[i];
    const double angle = yaw + k.angle_rad;
    const Eigen::Vector2f center = (guide.target_from_query * k.Position()).cast<float>();
    Collect({center.x(), center.y(), static_cast<float>(guide.radius_m), static_cast<float>(std::cos(angle)),
             static_cast<float>(std::sin(angle)), min_cos, k.size_m},
            &candidates);
    if (!candidates.empty()) {
      matches.push_back(FindAmong(query, packed, static_cast<int>(i), candidates));
    }
  }
  return matches;
}

}  // namespace floorloc
