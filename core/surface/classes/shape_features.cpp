// SPDX-License-Identifier: Apache-2.0
#include "core/surface/classes/shape_features.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace floorloc {
namespace {

constexpr int kTries = 40;            // finds a line that holds a quarter of the nearby points, with 92 %
constexpr int kMaxLines = 24;         // of a segment: more say nothing new
constexpr int kReach = 40;            // the two points of a sample are neighbours in the border's raster order
constexpr double kTolerancePx = 1.0;  // the border is one pixel wide
constexpr double kMaxGapPx = 3.0;
constexpr double kMinLengthPx = 12.0;
constexpr int kOrientations = 10;

// A piece of a line with the indices of its points.
struct Piece {
  double length = 0.0;
  double angle = 0.0;
  std::vector<std::size_t> points;
};

// The longest piece without a gap on the line through two points of the border.
Piece PieceAlong(const std::vector<cv::Point>& border, const cv::Point& a, const cv::Point& b) {
  const cv::Point2d delta = b - a;
  const double norm = std::hypot(delta.x, delta.y);
  const cv::Point2d along(delta.x / norm, delta.y / norm);
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t i = 0; i < border.size(); ++i) {
    const cv::Point2d to = border[i] - a;
    if (std::abs(along.x * to.y - along.y * to.x) <= kTolerancePx) {
      near.emplace_back(along.dot(to), i);
    }
  }
  std::sort(near.begin(), near.end());
  std::size_t begin = 0;
  std::size_t best_begin = 0;
  std::size_t best_end = 0;
  for (std::size_t i = 0; i < near.size(); ++i) {
    if (i > begin && near[i].first - near[i - 1].first > kMaxGapPx) {
      begin = i;
    }
    if (near[i].first - near[begin].first > near[best_end].first - near[best_begin].first) {
      best_begin = begin;
      best_end = i;
    }
  }
  Piece piece;
  piece.length = near[best_end].first - near[best_begin].first;
  piece.angle = std::fmod(std::atan2(along.y, along.x) + std::numbers::pi, std::numbers::pi);
  for (std::size_t i = best_begin; i <= best_end; ++i) {
    piece.points.push_back(near[i].second);
  }
  return piece;
}

Piece LongestPiece(const std::vector<cv::Point>& border, std::mt19937_64* random) {
  Piece longest;
  const auto count = static_cast<std::int64_t>(border.size());
  for (int i = 0; i < kTries; ++i) {
    const auto first = static_cast<std::int64_t>((*random)() % border.size());
    const auto step = static_cast<std::int64_t>((*random)() % (2 * kReach + 1)) - kReach;
    const std::int64_t second = std::clamp<std::int64_t>(first + step, 0, count - 1);
    if (first == second) {
      continue;
    }
    Piece piece = PieceAlong(border, border[static_cast<std::size_t>(first)], border[static_cast<std::size_t>(second)]);
    if (piece.length > longest.length) {
      longest = std::move(piece);
    }
  }
  return longest;
}

void Remove(const std::vector<std::size_t>& indices, std::vector<cv::Point>* points) {
  std::vector<char> gone(points->size(), 0);
  for (const std::size_t i : indices) {
    gone[i] = 1;
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points->size(); ++i) {
    if (gone[i] == 0) {
      (*points)[kept++] = (*points)[i];
    }
  }
  points->resize(kept);
}

// Pixels with a neighbour of another segment.
std::vector<std::vector<cv::Point>> Borders(const Segmentation& segmentation) {
  const cv::Mat& labels = segmentation.labels;
  std::vector<std::vector<cv::Point>> borders(static_cast<std::size_t>(segmentation.count));
  for (int y = 0; y < labels.rows; ++y) {
    const int* row = labels.ptr<int>(y);
    const int* above = labels.ptr<int>(std::max(y - 1, 0));
    const int* below = labels.ptr<int>(std::min(y + 1, labels.rows - 1));
    for (int x = 0; x < labels.cols; ++x) {
      const int left = row[std::max(x - 1, 0)];
      const int right = row[std::min(x + 1, labels.cols - 1)];
      if (left != row[x] || right != row[x] || above[x] != row[x] || below[x] != row[x]) {
        borders[static_cast<std::size_t>(row[x])].emplace_back(x, y);
      }
    }
  }
  return borders;
}

std::vector<float> ShapeOf(const std::vector<BorderLine>& lines, std::size_t border_px) {
  std::vector<float> numbers(static_cast<std::size_t>(GroupSize(FeatureGroup::kShape)), 0.0F);
  if (lines.empty()) {
    return numbers;
  }
  const auto count = static_cast<double>(lines.size());
  double sum = 0.0;
  double squares = 0.0;
  for (const BorderLine& line : lines) {
    sum += line.length_px;
    squares += line.length_px * line.length_px;
    const int bin = std::min(static_cast<int>(line.angle_rad / std::numbers::pi * kOrientations), kOrientations - 1);
    const int place = 4 + bin;
    numbers[static_cast<std::size_t>(place)] += static_cast<float>(1.0 / count);
  }
  numbers[0] = static_cast<float>(sum / static_cast<double>(border_px));
  numbers[1] = static_cast<float>(sum / count);
  numbers[2] = static_cast<float>(std::max(squares / count - sum / count * (sum / count), 0.0));
  numbers[3] = static_cast<float>(count);
  return numbers;
}

}  // namespace

std::vector<BorderLine> FindBorderLines(std::vector<cv::Point> border, std::mt19937_64* random) {
  std::vector<BorderLine> lines;
  while (lines.size() < kMaxLines && border.size() >= static_cast<std::size_t>(kMinLengthPx)) {
    const Piece piece = LongestPiece(border, random);
    if (piece.length < kMinLengthPx) {
      break;
    }
    lines.push_back({piece.length, piece.angle});
    Remove(piece.points, &border);
  }
  return lines;
}

void MeasureShape(const Segmentation& segmentation, std::uint64_t seed, std::vector<SegmentFeatures>* features) {
  std::mt19937_64 random(seed);
  const std::vector<std::vector<cv::Point>> borders = Borders(segmentation);
  for (std::size_t i = 0; i < features->size(); ++i) {
    (*features)[i].groups[static_cast<std::size_t>(FeatureGroup::kShape)] =
        ShapeOf(FindBorderLines(borders[i], &random), borders[i].size());
  }
}

}  // namespace floorloc
