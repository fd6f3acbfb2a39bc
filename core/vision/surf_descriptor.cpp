// SPDX-License-Identifier: Apache-2.0
#include "core/vision/surf_descriptor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/vision/multiversion.h"
#include "core/vision/surf.h"

namespace floorloc {
namespace {

constexpr int kCells = 20;          // wavelets along each side of the window, one scale apart
constexpr int kNodes = kCells + 1;  // box means at the cells' corners, which the wavelets are differences of
constexpr int kFields = 4;          // along each side
constexpr int kFieldCells = kCells / kFields;
constexpr float kSigma = 3.3F;  // of the wavelets' weights, in scales

using Nodes = std::array<std::array<std::int32_t, kNodes>, kNodes>;

struct Window {
  float x;  // of the middle, moved to the upper left corner of a box around it, in the integral image
  float y;
  float step_x;  // along the window's rows, px
  float step_y;
  int box;  // side, px
};

// Means (times the box's area) of upright boxes on a turned grid. A wavelet of side 2 s that is turned with the window
// is the difference between the boxes at its corners: no wavelet is computed along the picture's axes and turned.
FLOORLOC_WIDE_VECTORS void SampleNodes(const std::uint32_t* __restrict sums, std::ptrdiff_t stride,
                                       const Window& window, Nodes* __restrict nodes) {
  const auto row_stride = static_cast<int>(stride);
  const int down = window.box * row_stride;
  for (int j = 0; j < kNodes; ++j) {
    const auto v = static_cast<float>(j - kCells / 2);
    const float x0 = window.x - v * window.step_y + 0.5F;
    const float y0 = window.y + v * window.step_x + 0.5F;
    std::int32_t* const row = (*nodes)[static_cast<std::size_t>(j)].data();
    for (int i = 0; i < kNodes; ++i) {
      const auto u = static_cast<float>(i - kCells / 2);
      const int at = static_cast<int>(y0 + u * window.step_y) * row_stride + static_cast<int>(x0 + u * window.step_x);
      row[i] =
          static_cast<std::int32_t>(sums[at + down + window.box] - sums[at + down] - sums[at + window.box] + sums[at]);
    }
  }
}

using Weights = std::array<float, kCells>;

// One side of the Gaussian; the weight of a cell is the product of its row's and its column's.
Weights MakeWeights() {
  Weights weights{};
  for (int i = 0; i < kCells; ++i) {
    const float u = static_cast<float>(i) - 0.5F * (kCells - 1);
    weights[static_cast<std::size_t>(i)] = std::exp(-u * u / (2.0F * kSigma * kSigma));
  }
  return weights;
}

// Sums over the rows of one row of fields, still one per column.
struct ColumnSums {
  std::array<float, kCells> along{};
  std::array<float, kCells> across{};
  std::array<float, kCells> along_abs{};
  std::array<float, kCells> across_abs{};
};

FLOORLOC_INLINE void AddRow(const std::int32_t* __restrict upper, const std::int32_t* __restrict lower, float weight,
                            const Weights& weights, ColumnSums* __restrict sums) {
  for (std::size_t i = 0; i < kCells; ++i) {
    const std::int32_t falling = lower[i + 1] - upper[i];
    const std::int32_t rising = upper[i + 1] - lower[i];
    const float w = weight * weights[i];
    const float along = w * static_cast<float>(falling + rising);
    const float across = w * static_cast<float>(falling - rising);
    sums->along[i] += along;
    sums->across[i] += across;
    sums->along_abs[i] += std::abs(along);
    sums->across_abs[i] += std::abs(across);
  }
}

FLOORLOC_WIDE_VECTORS void SumFields(const Nodes& nodes, const Weights& weights, float* __restrict descriptor) {
  for (std::size_t field_row = 0; field_row < kFields; ++field_row) {
    ColumnSums sums;
    for (std::size_t j = field_row * kFieldCells; j < (field_row + 1) * kFieldCells; ++j) {
      AddRow(nodes[j].data(), nodes[j + 1].data(), weights[j], weights, &sums);
    }
    for (std::size_t field = 0; field < kFields; ++field) {
      float* const out = descriptor + 4 * (kFields * field_row + field);
      std::fill_n(out, 4, 0.0F);
      for (std::size_t i = field * kFieldCells; i < (field + 1) * kFieldCells; ++i) {
        out[0] += sums.along[i];
        out[1] += sums.across[i];
        out[2] += sums.along_abs[i];
        out[3] += sums.across_abs[i];
      }
    }
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

void DescribeSurf(const IntegralImage& picture, const cv::KeyPoint& keypoint, float* descriptor) {
  static const Weights kWeights = MakeWeights();
  const float scale = keypoint.size * kSurfScalePerSize;
  const float angle = keypoint.angle * std::numbers::pi_v<float> / 180.0F;
  const int box = std::max(cvRound(scale), 1);
  const float to_corner = 0.5F - 0.5F * static_cast<float>(box);
  const Window window{keypoint.pt.x + to_corner, keypoint.pt.y + to_corner, scale * std::cos(angle),
                      scale * std::sin(angle), box};
  Nodes nodes;
  SampleNodes(picture.data(), picture.stride(), window, &nodes);
  SumFields(nodes, kWeights, descriptor);
  Normalize(descriptor);
}

}  // namespace floorloc
