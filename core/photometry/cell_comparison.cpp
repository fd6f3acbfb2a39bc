// SPDX-License-Identifier: Apache-2.0
#include "core/photometry/cell_comparison.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace floorloc {
namespace {

// The mosaic around a pixel of the frame.
struct Surrounding {
  float left_top, right_top, left_bottom, right_bottom;
  float a, b;  // place between them

  float top() const { return left_top + a * (right_top - left_top); }
  float bottom() const { return left_bottom + a * (right_bottom - left_bottom); }
  float Value() const { return top() + b * (bottom() - top()) - FrameSamples::kMiddle; }
  // Per pixel, rightwards and upwards: image rows run against the y axis.
  float SlopeX() const {
    const float upper = right_top - left_top;
    return upper + b * (right_bottom - left_bottom - upper);
  }
  float SlopeY() const { return top() - bottom(); }
};

// False beyond the surveyed floor.
FLOORLOC_INLINE bool Look(const cv::Mat& gray, const CellWarp::Point& p, Surrounding* around) {
  if (!(p.u >= 0.0F && p.v >= 0.0F && p.u < static_cast<float>(gray.cols - 1) &&
        p.v < static_cast<float>(gray.rows - 1))) {
    return false;
  }
  const int column = static_cast<int>(p.u);
  const int row = static_cast<int>(p.v);
  const std::uint8_t* upper = gray.ptr<std::uint8_t>(row) + column;
  const std::uint8_t* lower = upper + gray.step[0];
  if (upper[0] == 0 || upper[1] == 0 || lower[0] == 0 || lower[1] == 0) {
    return false;
  }
  *around = {static_cast<float>(upper[0]), static_cast<float>(upper[1]),     static_cast<float>(lower[0]),
             static_cast<float>(lower[1]), p.u - static_cast<float>(column), p.v - static_cast<float>(row)};
  return true;
}

// True where the mosaic is known as far around a pixel as its contrast was normalised: at the edge of what was surveyed
// the frame, which sees more, has another contrast. To four sides: single dark pixels shall not hide their
// surroundings.
FLOORLOC_INLINE bool KnownAround(const RasterPatch& patch, const CellWarp::Point& p) {
  const int column = static_cast<int>(p.u);
  const int row = static_cast<int>(p.v);
  const int left = std::max(0, column - patch.window_px);
  const int right = std::min(patch.gray.cols - 1, column + patch.window_px);
  const int above = std::max(0, row - patch.window_px);
  const int below = std::min(patch.gray.rows - 1, row + patch.window_px);
  const std::uint8_t* middle = patch.gray.ptr<std::uint8_t>(row);
  return middle[left] != 0 && middle[right] != 0 && patch.gray.at<std::uint8_t>(above, column) != 0 &&
         patch.gray.at<std::uint8_t>(below, column) != 0;
}

// Wide vectors, as compilers do not make them of sums of floats by themselves.
typedef float Eight __attribute__((vector_size(32)));  // NOLINT(modernize-use-using): GCC ignores it in an alias

void AddTo(const Eight& sum, std::array<float, 8>* total) {
  for (std::size_t i = 0; i < total->size(); ++i) {
    (*total)[i] += sum[i];
  }
}

// Elements of a CellVector: slope along which axis, times which of (1, dx, dy).
constexpr std::array<std::size_t, 6> kAxis{0, 1, 0, 0, 1, 1};
constexpr std::array<std::size_t, 6> kPlace{0, 0, 1, 2, 1, 2};

constexpr std::size_t kMosaicPull = 4;  // in CellSums::pulls

// Index of the product of two of (1, dx, dy) among CellSums::slopes.
constexpr std::array<std::array<std::size_t, 3>, 3> kProduct{{{0, 1, 2}, {1, 3, 4}, {2, 4, 5}}};

}  // namespace

CellWarp MakeCellWarp(const FrameSamples& frame, const FramePlacement& placement, const RasterPatch& patch) {
  const Eigen::Matrix<float, 14, 1> n =
      (Eigen::Matrix<double, 14, 1>() << std::cos(placement.yaw_rad), std::sin(placement.yaw_rad),
       frame.camera_center(), frame.center(), patch.PixelFromMap(placement.middle_in_map), 1.0 / patch.resolution_m,
       placement.mounting)
          .finished()
          .cast<float>();
  return {n(0), n(1), n(2), n(3), n(4), n(5), n(6), n(7), n(8), n(9), n(10), n(11), n(12), n(13)};
}

float CellCorrelation::Correlation() const {
  const float variance_f = VarianceOfFrame();
  const float variance_m = VarianceOfMosaic();
  return variance_f > 0.0F && variance_m > 0.0F ? Covariance() / std::sqrt(variance_f * variance_m) : 0.0F;
}

void CellCorrelation::AddCounts(const CellCorrelation& other) {
  n += other.n;
  f += other.f;
  m += other.m;
  ff += other.ff;
  mm += other.mm;
  fm += other.fm;
}

CellMatrix CellSums::Information() const {
  CellMatrix matrix;
  for (std::size_t i = 0; i < kAxis.size(); ++i) {
    for (std::size_t k = 0; k < kAxis.size(); ++k) {
      matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
          static_cast<double>(slopes[kAxis[i] + kAxis[k]][kProduct[kPlace[i]][kPlace[k]]]);
    }
  }
  return matrix;
}

CellVector CellSums::Pull(double gain) const {
  CellVector pull;
  for (std::size_t i = 0; i < kAxis.size(); ++i) {
    const std::array<float, 8>& of_axis = pulls[kAxis[i]];
    pull(static_cast<Eigen::Index>(i)) =
        static_cast<double>(of_axis[kPlace[i]]) - gain * static_cast<double>(of_axis[kMosaicPull + kPlace[i]]);
  }
  return pull;
}

FLOORLOC_WIDE_VECTORS
void AddCell(std::span<const FrameSamples::Sample> samples, const Eigen::Vector2f& center, const CellWarp& warp,
             const RasterPatch& patch, CellSums* sums) {
  Eight counts{};
  Eight xx{};
  Eight xy{};
  Eight yy{};
  Eight pull_x{};
  Eight pull_y{};
  Surrounding around;
  for (const FrameSamples::Sample& s : samples) {
    const CellWarp::Point p = warp.At(s);
    if (!Look(patch.gray, p, &around) || (patch.has_gaps && !KnownAround(patch, p))) {
      continue;
    }
    const float f = s.value;
    const float m = around.Value();
    const float gx = around.SlopeX() * warp.per_m;
    const float gy = around.SlopeY() * warp.per_m;
    const float dx = s.x_m - center.x();
    const float dy = s.y_m - center.y();
    const Eight place{1.0F, dx, dy, dx * dx, dx * dy, dy * dy, 0.0F, 0.0F};
    const Eight pulls{f, f * dx, f * dy, 0.0F, m, m * dx, m * dy, 0.0F};
    counts += Eight{1.0F, f, m, f * f, m * m, f * m, 0.0F, 0.0F};
    xx += gx * gx * place;
    xy += gx * gy * place;
    yy += gy * gy * place;
    pull_x += gx * pulls;
    pull_y += gy * pulls;
  }
  sums->AddCounts({counts[0], counts[1], counts[2], counts[3], counts[4], counts[5]});
  AddTo(xx, &sums->slopes[0]);
  AddTo(xy, &sums->slopes[1]);
  AddTo(yy, &sums->slopes[2]);
  AddTo(pull_x, &sums->pulls[0]);
  AddTo(pull_y, &sums->pulls[1]);
}

void SampleMosaic(std::span<const FrameSamples::Sample> samples, const CellWarp& warp, const cv::Mat& gray,
                  std::span<float> values) {
  Surrounding around;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    values[i] = Look(gray, warp.At(samples[i]), &around) ? around.Value() : std::numeric_limits<float>::quiet_NaN();
  }
}

CellCorrelation CorrelateCell(std::span<const FrameSamples::Sample> samples, const CellWarp& warp,
                              const cv::Mat& gray) {
  CellCorrelation sums;
  Surrounding around;
  for (const FrameSamples::Sample& s : samples) {
    if (Look(gray, warp.At(s), &around)) {
      sums.Add(s.value, around.Value());
    }
  }
  return sums;
}

}  // namespace floorloc
