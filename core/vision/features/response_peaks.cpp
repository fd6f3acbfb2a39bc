// SPDX-License-Identifier: Apache-2.0
#include "core/vision/features/response_peaks.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <opencv2/core.hpp>

#include "core/vision/image/multiversion.h"

namespace floorloc {
namespace {

// Sets flags[i] where row[i] is above the threshold and its four neighbours: leaves few samples for the full test.
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

// Three layers around a sample (i, j).
struct Neighbourhood {
  const std::array<cv::Mat, 3>& layers;
  int i;
  int j;

  float at(int scale, int dj, int di) const {
    return layers[static_cast<std::size_t>(std::ptrdiff_t{scale} + 1)].ptr<float>(j + dj)[i + di];
  }
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

// Peak of the fitted parabola: offset in samples (x, y) and layers (scale).
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

void AddPeak(const Neighbourhood& n, std::vector<ResponsePeak>* found) {
  const cv::Vec3f offset = PeakOffset(n);
  // Larger offsets mean a ridge without a well-defined peak.
  if (std::abs(offset[0]) < 1.0F && std::abs(offset[1]) < 1.0F && std::abs(offset[2]) < 1.0F) {
    found->push_back({n.i, n.j, n.at(0, 0, 0), offset});
  }
}

}  // namespace

std::vector<ResponsePeak> FindPeaks(const std::array<cv::Mat, 3>& layers, int margin, float threshold) {
  std::vector<ResponsePeak> found;
  const cv::Mat& layer = layers[1];
  const int first = margin + 1;
  const int count = layer.cols - 2 * first;
  std::vector<std::uint8_t> flags(static_cast<std::size_t>(std::max(count, 0)));
  for (int j = first; j < layer.rows - first && count > 0; ++j) {
    FlagPeaks(layer.ptr<float>(j) + first, static_cast<std::ptrdiff_t>(layer.step1()), threshold, count, flags.data());
    const auto next = [&](std::size_t from) {
      const void* const flag = std::memchr(flags.data() + from, 1, flags.size() - from);
      return flag == nullptr ? flags.size()
                             : static_cast<std::size_t>(static_cast<const std::uint8_t*>(flag) - flags.data());
    };
    for (std::size_t i = next(0); i < flags.size(); i = next(i + 1)) {
      const Neighbourhood neighbourhood{layers, static_cast<int>(i) + first, j};
      if (IsMaximum(neighbourhood)) {
        AddPeak(neighbourhood, &found);
      }
    }
  }
  return found;
}

}  // namespace floorloc
