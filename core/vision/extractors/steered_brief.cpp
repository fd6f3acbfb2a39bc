// SPDX-License-Identifier: Apache-2.0
#include "core/vision/extractors/steered_brief.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <tuple>

#include "core/vision/image/multiversion.h"

namespace floorloc {
namespace {

constexpr int kPairs = 8 * kBriefBytes;
constexpr int kOrientationRadiusPx = 15;
constexpr int kRow = 32;  // row length of the orientation's disc, padded

// Two pixels, relative to the keypoint, px.
struct PixelPair {
  float ax, ay, bx, by;
};

std::array<PixelPair, kPairs> MakePattern() {
  constexpr double kSigmaPx = 6.0;  // a fifth of the patch
  constexpr double kMaxRadiusPx = 15.5;
  std::mt19937 random(1);
  // Sums of twelve uniform numbers: unlike std::normal_distribution the same on every platform.
  const auto gaussian = [&] {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) {
      sum += static_cast<double>(random()) / 4294967296.0;
    }
    return sum * kSigmaPx;
  };
  const auto draw = [&] {
    for (;;) {
      const double x = gaussian();
      const double y = gaussian();
      if (std::hypot(x, y) <= kMaxRadiusPx) {
        return std::pair(static_cast<float>(x), static_cast<float>(y));
      }
    }
  };
  std::array<PixelPair, kPairs> pattern{};
  for (PixelPair& pair : pattern) {
    std::tie(pair.ax, pair.ay) = draw();
    std::tie(pair.bx, pair.by) = draw();
  }
  return pattern;
}

// Weights of a row of the disc: 1 and x inside, 0 outside.
struct DiscRow {
  std::array<std::int16_t, kRow> one{};
  std::array<std::int16_t, kRow> x{};
};

std::array<DiscRow, 2 * kOrientationRadiusPx + 1> MakeDisc() {
  std::array<DiscRow, 2 * kOrientationRadiusPx + 1> disc{};
  for (std::size_t row = 0; row < disc.size(); ++row) {
    for (std::size_t column = 0; column < disc.size(); ++column) {
      const int x = static_cast<int>(column) - kOrientationRadiusPx;
      const int y = static_cast<int>(row) - kOrientationRadiusPx;
      if (x * x + y * y <= kOrientationRadiusPx * kOrientationRadiusPx) {
        disc[row].one[column] = 1;
        disc[row].x[column] = static_cast<std::int16_t>(x);
      }
    }
  }
  return disc;
}

struct Moments {
  int x = 0;
  int y = 0;
};

FLOORLOC_WIDE_VECTORS
Moments MomentsAt(const std::uint8_t* top_left, std::size_t step, const DiscRow* disc) {
  Moments moments;
  for (int y = -kOrientationRadiusPx; y <= kOrientationRadiusPx; ++y) {
    const DiscRow& row = disc[y + kOrientationRadiusPx];
    int sum = 0;
    int sum_x = 0;
    for (std::size_t i = 0; i < kRow; ++i) {
      sum += row.one[i] * top_left[i];
      sum_x += row.x[i] * top_left[i];
    }
    moments.x += sum_x;
    moments.y += y * sum;
    top_left += step;
  }
  return moments;
}

struct Turn {
  float cosine;
  float sine;
};

FLOORLOC_WIDE_VECTORS
void TurnPattern(const PixelPair* pattern, const Turn& turn, int step, int* __restrict a, int* __restrict b) {
  const float c = turn.cosine;
  const float s = turn.sine;
  for (int i = 0; i < kPairs; ++i) {
    const PixelPair& p = pattern[i];
    // Makes numbers positive, so that truncation rounds half up.
    constexpr float kShift = 64.5F;
    const int ax = static_cast<int>(c * p.ax - s * p.ay + kShift) - 64;
    const int ay = static_cast<int>(s * p.ax + c * p.ay + kShift) - 64;
    const int bx = static_cast<int>(c * p.bx - s * p.by + kShift) - 64;
    const int by = static_cast<int>(s * p.bx + c * p.by + kShift) - 64;
    a[i] = ay * step + ax;
    b[i] = by * step + bx;
  }
}

// Rows are independent of each other: the offsets of the pairs are those of a row's angle.
void CompareAll(const std::int16_t* center, const std::array<int, kPairs>& a, const std::array<int, kPairs>& b,
                std::uint8_t* row) {
  for (std::size_t byte = 0; byte < kBriefBytes; ++byte) {
    int bits = 0;
    for (std::size_t bit = 0; bit < 8; ++bit) {
      bits |= static_cast<int>(center[a[8 * byte + bit]] < center[b[8 * byte + bit]]) << bit;
    }
    row[byte] = static_cast<std::uint8_t>(bits);
  }
}

const std::array<PixelPair, kPairs>& Pattern() {
  static const std::array<PixelPair, kPairs> pattern = MakePattern();
  return pattern;
}

Turn TurnOf(float angle_deg) {
  const float angle = angle_deg * std::numbers::pi_v<float> / 180.0F;
  return {std::cos(angle), std::sin(angle)};
}

}  // namespace

void OrientByCentroid(const cv::Mat& image, std::vector<cv::KeyPoint>* keypoints) {
  static const std::array<DiscRow, 2 * kOrientationRadiusPx + 1> disc = MakeDisc();
  for (cv::KeyPoint& k : *keypoints) {
    const int u = cvRound(k.pt.x) - kOrientationRadiusPx;
    const int v = cvRound(k.pt.y) - kOrientationRadiusPx;
    const Moments m = MomentsAt(image.ptr<std::uint8_t>(v) + u, image.step[0], disc.data());
    const double angle = std::atan2(static_cast<double>(m.y), static_cast<double>(m.x)) * 180.0 / std::numbers::pi;
    k.angle = static_cast<float>(angle < 0.0 ? angle + 360.0 : angle);
  }
}

cv::Mat DescribeBrief(const cv::Mat& smooth, const std::vector<cv::KeyPoint>& keypoints) {
  cv::Mat descriptors(static_cast<int>(keypoints.size()), kBriefBytes, CV_8UC1);
  const auto step = static_cast<int>(smooth.step1());
  std::array<int, kPairs> a{};
  std::array<int, kPairs> b{};
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const cv::KeyPoint& k = keypoints[i];
    TurnPattern(Pattern().data(), TurnOf(k.angle), step, a.data(), b.data());
    const std::int16_t* center = smooth.ptr<std::int16_t>(cvRound(k.pt.y)) + cvRound(k.pt.x);
    CompareAll(center, a, b, descriptors.ptr<std::uint8_t>(static_cast<int>(i)));
  }
  return descriptors;
}

cv::Mat DescribeBriefAt(const cv::Mat& smooth, const std::vector<cv::Point2f>& points, float angle_deg) {
  cv::Mat descriptors = cv::Mat::zeros(static_cast<int>(points.size()), kBriefBytes, CV_8UC1);
  std::array<int, kPairs> a{};
  std::array<int, kPairs> b{};
  TurnPattern(Pattern().data(), TurnOf(angle_deg), static_cast<int>(smooth.step1()), a.data(), b.data());
  const cv::Rect inside(kBriefReachPx, kBriefReachPx, smooth.cols - 2 * kBriefReachPx, smooth.rows - 2 * kBriefReachPx);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const cv::Point center(cvRound(points[i].x), cvRound(points[i].y));
    if (inside.contains(center)) {
      CompareAll(smooth.ptr<std::int16_t>(center.y) + center.x, a, b,
                 descriptors.ptr<std::uint8_t>(static_cast<int>(i)));
    }
  }
  return descriptors;
}

}  // namespace floorloc
