// SPDX-License-Identifier: Apache-2.0
#include "core/vision/surf_detector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <opencv2/core.hpp>

#include "core/vision/multiversion.h"
#include "core/vision/surf_response.h"

namespace floorloc {
namespace {

// Sets flags[i] where row[i] is above the threshold and its four neighbours: few samples are left for the full test.
FLOORLOC_WIDE_VECTORS void FlagPeaks(const float* __restrict row, std::ptrdiff_t stride, float threshold, int count,
                                     std::uint8_t* __restrict flags) {
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const float value = row[i];
    const int peak = static_cast<int>(value > threshold) & static_cast<int>(value >= row[i - 1]) &
                     static_cast<int>(value > row[i + 1]) & static_cast<int>(value >= row[i - stride]) &
                     static_cast<int>(value > row[i + stride]);
    flags[i] = static_cast<std::uint8_t>(peak);
  }
}

// Three layers of one octave around a sample (i, j).
struct Neighbourhood {
  std::array<const ResponseLayer*, 3> layers;
  int i;
  int j;

  float at(int scale, int dj, int di) const { return layers[static_cast<std::size_t>(scale + 1)]->row(j + dj)[i + di]; }
};

// Of equal neighbours the last in order of scale, row and column is the maximum: a plateau has one.
bool IsMaximum(const Neighbourhood& n) {
  const float value = n.at(0, 0, 0);
  for (int scale = -1; scale <= 1; ++scale) {
    for (int dj = -1; dj <= 1; ++dj) {
      for (int di = -1; di <= 1; ++di) {
        const int order = 9 * scale + 3 * dj + di;
        const float other = n.at(scale, dj, di);
        if (order < 0 ? other > value : order > 0 && other >= value) {
          return false;
        }
      }
    }
  }
  return true;
}

// Where the parabola through the neighbours peaks: samples in x and y, layers in scale.
cv::Vec3f PeakOffset(const Neighbourhood& n) {
  const float twice = 2.0F * n.at(0, 0, 0);
  const float xx = n.at(0, 0, 1) + n.at(0, 0, -1) - twice;
  const float yy = n.at(0, 1, 0) + n.at(0, -1, 0) - twice;
  const float ss = n.at(1, 0, 0) + n.at(-1, 0, 0) - twice;
  const float xy = 0.25F * (n.at(0, 1, 1) + n.at(0, -1, -1) - n.at(0, 1, -1) - n.at(0, -1, 1));
  const float xs = 0.25F * (n.at(1, 0, 1) + n.at(-1, 0, -1) - n.at(1, 0, -1) - n.at(-1, 0, 1));
  const float ys = 0.25F * (n.at(1, 1, 0) + n.at(-1, -1, 0) - n.at(1, -1, 0) - n.at(-1, 1, 0));
  const cv::Matx33f hessian(xx, xy, xs, xy, yy, ys, xs, ys, ss);
  const cv::Vec3f gradient(0.5F * (n.at(0, 0, 1) - n.at(0, 0, -1)), 0.5F * (n.at(0, 1, 0) - n.at(0, -1, 0)),
                           0.5F * (n.at(1, 0, 0) - n.at(-1, 0, 0)));
  return hessian.solve(-gradient, cv::DECOMP_LU);
}

void AddKeypoint(const IntegralImage& picture, int octave, const Neighbourhood& n, std::vector<cv::KeyPoint>* found) {
  const cv::Vec3f offset = PeakOffset(n);
  // Not a peak but a ridge: the parabola runs away.
  if (!(std::abs(offset[0]) < 1.0F && std::abs(offset[1]) < 1.0F && std::abs(offset[2]) < 1.0F)) {
    return;
  }
  const ResponseLayer& layer = *n.layers[1];
  const auto step = static_cast<float>(layer.step_px);
  const auto size_step = static_cast<float>(layer.filter_px - n.layers[0]->filter_px);
  const bool dark = LaplacianAt(picture, layer.filter_px, n.i * layer.step_px, n.j * layer.step_px) > 0.0F;
  found->emplace_back((static_cast<float>(n.i) + offset[0]) * step, (static_cast<float>(n.j) + offset[1]) * step,
                      static_cast<float>(layer.filter_px) + offset[2] * size_step, -1.0F, n.at(0, 0, 0), octave,
                      dark ? 1 : -1);
}

void FindMaxima(const IntegralImage& picture, const SurfOptions& options, int octave,
                const std::array<const ResponseLayer*, 3>& layers, std::vector<cv::KeyPoint>* found) {
  const ResponseLayer& layer = *layers[1];
  const int margin = layers[2]->margin + 1;
  const int count = layer.response.cols - 2 * margin;
  std::vector<std::uint8_t> flags(static_cast<std::size_t>(std::max(count, 0)));
  for (int j = margin; j < layer.response.rows - margin && count > 0; ++j) {
    FlagPeaks(layer.row(j) + margin, layer.response.cols, static_cast<float>(options.threshold), count, flags.data());
    const auto next = [&](std::size_t from) {
      const void* const flag = std::memchr(flags.data() + from, 1, flags.size() - from);
      return flag == nullptr ? flags.size()
                             : static_cast<std::size_t>(static_cast<const std::uint8_t*>(flag) - flags.data());
    };
    for (std::size_t i = next(0); i < flags.size(); i = next(i + 1)) {
      const Neighbourhood neighbourhood{layers, static_cast<int>(i) + margin, j};
      if (IsMaximum(neighbourhood)) {
        AddKeypoint(picture, octave, neighbourhood, found);
      }
    }
  }
}

}  // namespace

std::vector<cv::KeyPoint> DetectFastHessian(const IntegralImage& picture, const SurfOptions& options) {
  std::vector<cv::KeyPoint> found;
  ResponseOctave layers;
  for (int octave = 0; octave < options.octaves; ++octave) {
    layers = ComputeOctave(picture, octave, options.layers + 2, layers, options.first_step_px);
    for (std::size_t i = 1; i + 1 < layers.size(); ++i) {
      FindMaxima(picture, options, octave, {&layers[i - 1], &layers[i], &layers[i + 1]}, &found);
    }
  }
  return found;
}

}  // namespace floorloc
