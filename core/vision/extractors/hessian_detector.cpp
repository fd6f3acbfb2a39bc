// SPDX-License-Identifier: Apache-2.0
#include "core/vision/extractors/hessian_detector.h"

#include <algorithm>
#include <array>

#include "core/vision/image/multiversion.h"

namespace floorloc {
namespace {

// Non-maximum suppression in a square of this half side.
constexpr int kRadiusPx = 3;
// Rows of responses in use at a time.
constexpr int kRows = 2 * kRadiusPx + 1;

// Determinant of the Hessian by central differences over one pixel, of a row; upper and lower are its neighbours.
FLOORLOC_WIDE_VECTORS
void RespondRow(const float* __restrict upper, const float* __restrict middle, const float* __restrict lower, int width,
                float* __restrict response) {
  for (int u = 1; u < width - 1; ++u) {
    const float xx = middle[u - 1] - 2.0F * middle[u] + middle[u + 1];
    const float yy = upper[u] - 2.0F * middle[u] + lower[u];
    const float xy = 0.25F * (lower[u + 1] - lower[u - 1] - upper[u + 1] + upper[u - 1]);
    response[u] = xx * yy - xy * xy;
  }
}

// Largest response of the columns u - radius .. u + radius, of all rows, for every u.
FLOORLOC_WIDE_VECTORS
void MaximumOfRows(const std::array<const float*, kRows>& rows, int width, float* __restrict column_max,
                   float* __restrict maximum) {
  for (int u = 0; u < width; ++u) {
    float m = rows[0][u];
    for (int r = 1; r < kRows; ++r) {
      m = std::max(m, rows[static_cast<std::size_t>(r)][u]);
    }
    column_max[u] = m;
  }
  for (int u = kRadiusPx; u < width - kRadiusPx; ++u) {
    float m = column_max[u - kRadiusPx];
    for (int d = 1 - kRadiusPx; d <= kRadiusPx; ++d) {
      m = std::max(m, column_max[u + d]);
    }
    maximum[u] = m;
  }
}

// Where the parabola through three responses peaks, relative to the middle one.
float PeakOffset(float before, float at, float after) {
  const float curvature = before - 2.0F * at + after;
  return curvature < 0.0F ? std::clamp(0.5F * (before - after) / curvature, -0.5F, 0.5F) : 0.0F;
}

}  // namespace

std::vector<cv::KeyPoint> DetectHessian(const cv::Mat& smooth, int border_px, float min_response) {
  std::vector<cv::KeyPoint> keypoints;
  const int border = std::max(border_px, kRadiusPx + 1);
  if (smooth.rows <= 2 * border || smooth.cols <= 2 * border) {
    return keypoints;
  }
  cv::Mat response = cv::Mat::zeros(smooth.size(), CV_32F);
  const auto respond = [&](int v) {
    RespondRow(smooth.ptr<float>(v - 1), smooth.ptr<float>(v), smooth.ptr<float>(v + 1), smooth.cols,
               response.ptr<float>(v));
  };
  for (int v = border - kRadiusPx; v < border + kRadiusPx; ++v) {
    respond(v);
  }
  std::vector<float> column_max(static_cast<std::size_t>(smooth.cols));
  std::vector<float> maximum(static_cast<std::size_t>(smooth.cols));
  std::array<const float*, kRows> rows{};
  for (int v = border; v < smooth.rows - border; ++v) {
    respond(v + kRadiusPx);
    for (int r = 0; r < kRows; ++r) {
      rows[static_cast<std::size_t>(r)] = response.ptr<float>(v - kRadiusPx + r);
    }
    MaximumOfRows(rows, smooth.cols, column_max.data(), maximum.data());
    const float* above = rows[kRadiusPx - 1];
    const float* at = rows[kRadiusPx];
    const float* below = rows[kRadiusPx + 1];
    for (int u = border; u < smooth.cols - border; ++u) {
      // Of equal neighbours the first one is the maximum.
      const bool is_maximum = at[u] == maximum[static_cast<std::size_t>(u)] && at[u] > at[u - 1] &&
                              at[u] > above[u - 1] && at[u] > above[u] && at[u] > above[u + 1];
      if (is_maximum && at[u] > min_response) {
        keypoints.emplace_back(static_cast<float>(u) + PeakOffset(at[u - 1], at[u], at[u + 1]),
                               static_cast<float>(v) + PeakOffset(above[u], at[u], below[u]), 0.0F, -1.0F, at[u]);
      }
    }
  }
  return keypoints;
}

}  // namespace floorloc
