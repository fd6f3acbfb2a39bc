// SPDX-License-Identifier: Apache-2.0
#include "core/vision/freak_star/star.h"

#include <array>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "core/vision/features/keypoint_selection.h"
#include "core/vision/features/response_peaks.h"
#include "core/vision/freak_star/star_response.h"

namespace floorloc {
namespace {

void Require(bool ok, const char* message) {
  if (!ok) {
    throw std::invalid_argument(message);
  }
}

// Whether the response changes in one direction only, as on edges and scratches, so that the position along the line is
// undetermined. Uses the gradients of the response within the inner star.
bool IsOnLine(const cv::Mat& response, const ResponsePeak& peak, int radius, double max_ratio) {
  double xx = 0.0;
  double yy = 0.0;
  double xy = 0.0;
  for (int y = peak.j - radius; y <= peak.j + radius; ++y) {
    const float* const row = response.ptr<float>(y);
    const float* const above = response.ptr<float>(y - 1);
    const float* const below = response.ptr<float>(y + 1);
    for (int x = peak.i - radius; x <= peak.i + radius; ++x) {
      const double dx = row[x + 1] - row[x - 1];
      const double dy = below[x] - above[x];
      xx += dx * dx;
      yy += dy * dy;
      xy += dx * dy;
    }
  }
  const double trace = xx + yy;
  const double determinant = xx * yy - xy * xy;
  return trace * trace * max_ratio > determinant * (max_ratio + 1.0) * (max_ratio + 1.0);
}

// Interpolates between the sizes of neighbouring scales.
float InterpolatedSize(const StarScale* scale, float offset) {
  const auto size = static_cast<float>(scale->size_px());
  const auto other = static_cast<float>((offset < 0.0F ? scale - 1 : scale + 1)->size_px());
  return size + std::abs(offset) * (other - size);
}

}  // namespace

void StarOptions::Check() const {
  Require(threshold >= 0.0 && threshold <= 255.0, "threshold must be 0 to 255");
  Require(max_size_px >= 17 && max_size_px <= 129, "max_size_px must be 17 to 129");
  Require(line_ratio >= 1.0 && line_ratio <= 1e6, "line_ratio must be 1 to 1000000");
  Require(max_keypoints >= 0, "max_keypoints must be 0 (all) or more");
}

Star::Star(const StarOptions& options) : options_(options) { options_.Check(); }

std::vector<cv::KeyPoint> Star::Detect(const cv::Mat& gray, const cv::Mat& mask) const {
  std::vector<cv::KeyPoint> found;
  const IntegralImage squares(gray);
  if (gray.empty()) {
    return found;
  }
  const TriangleSums triangles(gray);
  const std::vector<StarScale> scales = StarScales(options_.max_size_px);
  std::vector<cv::Mat> dark;
  std::vector<cv::Mat> bright;
  for (const StarScale& scale : scales) {
    dark.push_back(StarResponse(squares, triangles, scale));
    bright.emplace_back(-dark.back());
  }
  for (const int sign : {1, -1}) {
    const std::vector<cv::Mat>& responses = sign > 0 ? dark : bright;
    for (std::size_t i = 1; i + 1 < scales.size(); ++i) {
      const std::array<cv::Mat, 3> layers{responses[i - 1], responses[i], responses[i + 1]};
      const int margin = scales[i + 1].outer.tip;
      for (const ResponsePeak& peak : FindPeaks(layers, margin, static_cast<float>(options_.threshold))) {
        if (!IsOnLine(layers[1], peak, scales[i].inner.tip, options_.line_ratio)) {
          found.emplace_back(static_cast<float>(peak.i) + peak.offset[0], static_cast<float>(peak.j) + peak.offset[1],
                             InterpolatedSize(&scales[i], peak.offset[2]), -1.0F, peak.value, static_cast<int>(i),
                             sign);
        }
      }
    }
  }
  KeepStrongest(mask, options_.max_keypoints, &found);
  return found;
}

}  // namespace floorloc
