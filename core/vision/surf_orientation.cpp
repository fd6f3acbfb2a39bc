// SPDX-License-Identifier: Apache-2.0
#include "core/vision/surf_orientation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core/hal/hal.hpp>

#include "core/vision/multiversion.h"
#include "core/vision/surf.h"

namespace floorloc {
namespace {

constexpr int kRadius = 6;      // of the disc of samples, in scales
constexpr int kSamples = 109;   // grid points strictly inside that disc
constexpr int kBins = 72;       // of 5 degrees
constexpr int kWindow = 12;     // bins: 60 degrees
constexpr float kSigma = 2.5F;  // of the samples' weights, in scales

// The disc: offsets in scales and weights.
struct Disc {
  std::array<float, kSamples> dx;
  std::array<float, kSamples> dy;
  std::array<float, kSamples> weight;
};

Disc MakeDisc() {
  Disc disc{};
  std::size_t n = 0;
  for (int y = -kRadius; y <= kRadius; ++y) {
    for (int x = -kRadius; x <= kRadius; ++x) {
      if (x * x + y * y < kRadius * kRadius) {
        disc.dx[n] = static_cast<float>(x);
        disc.dy[n] = static_cast<float>(y);
        disc.weight[n] = std::exp(-static_cast<float>(x * x + y * y) / (2.0F * kSigma * kSigma));
        ++n;
      }
    }
  }
  return disc;
}

struct Wavelets {
  std::array<float, kSamples> x;
  std::array<float, kSamples> y;
};

struct Place {
  float x;  // corner coordinates: 0 is the picture's left and upper edge
  float y;
  float scale;
  int half;  // half side of a wavelet, px
};

FLOORLOC_WIDE_VECTORS void Sample(const std::uint32_t* __restrict sums, const cv::Size& size, const Place& place,
                                  const Disc& disc, Wavelets* __restrict wavelets) {
  const int stride = size.width + 1;
  const int half = place.half;
  const int right = size.width - half;
  const int bottom = size.height - half;
  for (int n = 0; n < kSamples; ++n) {
    const auto k = static_cast<std::size_t>(n);
    const int x = std::min(std::max(static_cast<int>(place.x + disc.dx[k] * place.scale + 0.5F), half), right);
    const int y = std::min(std::max(static_cast<int>(place.y + disc.dy[k] * place.scale + 0.5F), half), bottom);
    const int up = (y - half) * stride + x;
    const int at = y * stride + x;
    const int down = (y + half) * stride + x;
    const std::uint32_t to_right = sums[down + half] - sums[up + half] + sums[down - half] - sums[up - half];
    const std::uint32_t to_bottom = sums[down + half] - sums[down - half] + sums[up + half] - sums[up - half];
    const std::uint32_t wavelet_x = to_right - 2 * (sums[down] - sums[up]);
    const std::uint32_t wavelet_y = to_bottom - 2 * (sums[at + half] - sums[at - half]);
    wavelets->x[k] = static_cast<float>(static_cast<std::int32_t>(wavelet_x)) * disc.weight[k];
    wavelets->y[k] = static_cast<float>(static_cast<std::int32_t>(wavelet_y)) * disc.weight[k];
  }
}

// The direction of the strongest sum of wavelets in a window that slides over their directions.
float StrongestDirection(const Wavelets& wavelets) {
  std::array<float, kSamples> degrees;
  cv::hal::fastAtan32f(wavelets.y.data(), wavelets.x.data(), degrees.data(), kSamples, true);
  std::array<cv::Point2f, kBins + kWindow> bins{};
  for (std::size_t n = 0; n < kSamples; ++n) {
    const auto bin = std::min(static_cast<std::size_t>(degrees[n] * (kBins / 360.0F)), std::size_t{kBins - 1});
    bins[bin] += cv::Point2f(wavelets.x[n], wavelets.y[n]);
  }
  std::copy_n(bins.begin(), kWindow, bins.begin() + kBins);
  cv::Point2f best;
  for (std::size_t first = 0; first < kBins; ++first) {
    cv::Point2f sum;
    for (std::size_t n = first; n < first + kWindow; ++n) {
      sum += bins[n];
    }
    best = sum.dot(sum) > best.dot(best) ? sum : best;
  }
  return cv::fastAtan2(best.y, best.x);
}

}  // namespace

float SurfOrientation(const IntegralImage& picture, const cv::KeyPoint& keypoint) {
  static const Disc kDisc = MakeDisc();
  const float scale = keypoint.size * kSurfScalePerSize;
  const int widest = std::min(picture.width(), picture.height()) / 2;
  const int half = std::min(std::max(cvRound(2.0F * scale), 1), widest);
  if (half == 0) {
    return 0.0F;
  }
  Wavelets wavelets;
  const Place place{keypoint.pt.x + 0.5F, keypoint.pt.y + 0.5F, scale, half};
  Sample(picture.data(), {picture.width(), picture.height()}, place, kDisc, &wavelets);
  return StrongestDirection(wavelets);
}

}  // namespace floorloc
