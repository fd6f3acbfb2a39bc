// SPDX-License-Identifier: Apache-2.0
#include "core/vision/surf/surf_descriptor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/vision/image/multiversion.h"
#include "core/vision/surf/surf.h"

namespace floorloc {
namespace {

constexpr int kCells = 20;          // wavelets along each side of the window, one scale apart
constexpr int kNodes = kCells + 1;  // box means at the cells' corners; the wavelets are their differences
constexpr int kFields = 4;          // along each side
constexpr int kChannels = 4;        // per field
// Gaussian weights of the wavelets about the centre of a field and of the fields about the keypoint, in scales.
constexpr float kFieldSigma = 2.5F;
constexpr float kWindowSigma = 9.0F;

using Nodes = std::array<float, kNodes * kNodes>;
// Per field along a side the weights of the cells along it. Fields overlap: a wavelet near the border of two
// contributes to both, so that small errors of position, angle or scale change little. The weight of a cell for a field
// is the product of its row's and its column's.
using Weights = std::array<std::array<float, kCells>, kFields>;

Weights MakeWeights() {
  Weights weights{};
  for (int field = 0; field < kFields; ++field) {
    constexpr int kCellsPerField = kCells / kFields;
    const float middle = (static_cast<float>(field) - 0.5F * (kFields - 1)) * kCellsPerField;
    const float of_field = std::exp(-middle * middle / (2.0F * kWindowSigma * kWindowSigma));
    for (int i = 0; i < kCells; ++i) {
      const float u = static_cast<float>(i) - 0.5F * (kCells - 1) - middle;
      weights[static_cast<std::size_t>(field)][static_cast<std::size_t>(i)] =
          of_field * std::exp(-u * u / (2.0F * kFieldSigma * kFieldSigma));
    }
  }
  return weights;
}

// Wavelet responses of one row of cells, cell by cell: along and across the window's rows, and their absolute values.
using WaveletRow = std::array<float, kCells * kChannels>;

FLOORLOC_INLINE void MakeWavelets(const float* __restrict upper, const float* __restrict lower, float* __restrict row) {
  for (int i = 0; i < kCells; ++i) {
    const float falling = lower[i + 1] - upper[i];
    const float rising = upper[i + 1] - lower[i];
    row[kChannels * i] = falling + rising;
    row[kChannels * i + 1] = falling - rising;
    row[kChannels * i + 2] = std::abs(falling + rising);
    row[kChannels * i + 3] = std::abs(falling - rising);
  }
}

FLOORLOC_WIDE_VECTORS void SumFields(const Nodes& nodes, const Weights& weights, float* __restrict descriptor) {
  std::array<WaveletRow, kFields> sums{};  // of the rows, for each row of fields
  WaveletRow row;
  for (std::size_t j = 0; j < kCells; ++j) {
    MakeWavelets(nodes.data() + j * kNodes, nodes.data() + (j + 1) * kNodes, row.data());
    for (std::size_t field = 0; field < kFields; ++field) {
      const float weight = weights[field][j];
      for (std::size_t n = 0; n < row.size(); ++n) {
        sums[field][n] += weight * row[n];
      }
    }
  }
  for (std::size_t field = 0; field < kFields * kFields; ++field) {
    const float* __restrict const sum = sums[field / kFields].data();
    std::array<float, kChannels> channels{};
    for (std::size_t i = 0; i < kCells; ++i) {
      const float weight = weights[field % kFields][i];
      for (std::size_t channel = 0; channel < kChannels; ++channel) {
        channels[channel] += weight * sum[kChannels * i + channel];
      }
    }
    std::copy(channels.begin(), channels.end(), descriptor + kChannels * field);
  }
}

void Normalize(float* descriptor) {
  float squares = 0.0F;
  for (int i = 0; i < kSurfLength; ++i) {
    squares += descriptor[i] * descriptor[i];
  }
  const float factor = squares > 0.0F ? 1.0F / std::sqrt(squares) : 0.0F;
  for (int i = 0; i < kSurfLength; ++i) {
    descriptor[i] *= factor;
  }
}

}  // namespace

void DescribeSurf(const cv::KeyPoint& keypoint, BoxSampler* sampler, float* descriptor) {
  static const Weights kWeights = MakeWeights();
  const float scale = keypoint.size * kSurfScalePerSize;
  const float angle = keypoint.angle * std::numbers::pi_v<float> / 180.0F;
  static const SamplePattern kGrid = SquareGrid(kNodes);
  Nodes nodes;
  sampler->Sample(kGrid, {keypoint.pt, {scale * std::cos(angle), scale * std::sin(angle)}, std::max(cvRound(scale), 1)},
                  nodes.data());
  SumFields(nodes, kWeights, descriptor);
  Normalize(descriptor);
}

}  // namespace floorloc
