// SPDX-License-Identifier: Apache-2.0
#include "core/vision/surf/surf_orientation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core/hal/hal.hpp>

#include "core/vision/surf/surf.h"

namespace floorloc {
namespace {

constexpr int kRadius = 6;                     // of the disc of wavelets, in scales
constexpr int kWavelets = 109;                 // grid points strictly inside that disc
constexpr int kNodes = 2 * (kRadius + 1) - 1;  // along each side of the grid of box means, one scale apart
constexpr int kBins = 72;                      // of 5 degrees
constexpr int kWindow = 12;                    // bins: 60 degrees
constexpr float kSigma = 2.5F;                 // of the wavelets' weights, in scales

// Positions of the wavelets among the nodes, and their weights.
struct Disc {
  std::array<std::size_t, kWavelets> node;
  std::array<float, kWavelets> weight;
};

Disc MakeDisc() {
  Disc disc{};
  std::size_t n = 0;
  for (int y = 1 - kRadius; y < kRadius; ++y) {
    for (int x = 1 - kRadius; x < kRadius; ++x) {
      if (x * x + y * y < kRadius * kRadius) {
        const int node = (y + kRadius) * kNodes + x + kRadius;
        disc.node[n] = static_cast<std::size_t>(node);
        disc.weight[n] = std::exp(-static_cast<float>(x * x + y * y) / (2.0F * kSigma * kSigma));
        ++n;
      }
    }
  }
  return disc;
}

struct Wavelets {
  std::array<float, kWavelets> x;
  std::array<float, kWavelets> y;
};

// A wavelet of side 4 s is composed of the four squares of side 2 s around it.
Wavelets MakeWavelets(const std::array<float, kNodes * kNodes>& nodes) {
  static const Disc kDisc = MakeDisc();
  Wavelets wavelets;
  for (std::size_t k = 0; k < kWavelets; ++k) {
    const float* const node = nodes.data() + kDisc.node[k];
    const float falling = node[kNodes + 1] - node[-kNodes - 1];
    const float rising = node[-kNodes + 1] - node[kNodes - 1];
    wavelets.x[k] = kDisc.weight[k] * (falling + rising);
    wavelets.y[k] = kDisc.weight[k] * (falling - rising);
  }
  return wavelets;
}

// Direction of the largest sum of wavelets in a sliding window over their directions.
float StrongestDirection(const Wavelets& wavelets) {
  std::array<float, kWavelets> degrees;
  cv::hal::fastAtan32f(wavelets.y.data(), wavelets.x.data(), degrees.data(), kWavelets, true);
  std::array<cv::Point2f, kBins + kWindow> bins{};
  for (std::size_t n = 0; n < kWavelets; ++n) {
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

float SurfOrientation(const cv::KeyPoint& keypoint, BoxSampler* sampler) {
  const float scale = keypoint.size * kSurfScalePerSize;
  static const SamplePattern kGrid = SquareGrid(kNodes);
  std::array<float, kNodes * kNodes> nodes;
  sampler->Sample(kGrid, {keypoint.pt, {scale, 0.0F}, std::max(cvRound(2.0F * scale), 1)}, nodes.data());
  return StrongestDirection(MakeWavelets(nodes));
}

}  // namespace floorloc
