// SPDX-License-Identifier: Apache-2.0
#include "core/vision/image/contrast.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/option_check.h"
#include "core/vision/image/gaussian.h"
#include "core/vision/image/mirror.h"
#include "core/vision/image/multiversion.h"

namespace floorloc {
namespace {

constexpr float kMiddle = 128.0F;
constexpr float kGain = 40.0F;
// Lower bound of the standard deviation, so that camera noise is not amplified to full contrast.
constexpr float kMinDeviation = 1.0F;

using Row = std::vector<float>;

FLOORLOC_WIDE_VECTORS
void AddShifted(const float* __restrict in, int shift, int width, float* __restrict sum) {
  for (int u = 0; u < width; ++u) {
    sum[u] += in[u + shift];
  }
}

FLOORLOC_WIDE_VECTORS
void Double(const float* __restrict in, int shift, int width, float* __restrict out) {
  for (int u = 0; u < width; ++u) {
    out[u] = in[u] + in[u + shift];
  }
}

FLOORLOC_WIDE_VECTORS
void Square(const float* __restrict in, int width, float* __restrict out) {
  for (int u = 0; u < width; ++u) {
    out[u] = in[u] * in[u];
  }
}

FLOORLOC_WIDE_VECTORS
void AddDifference(const float* __restrict add, const float* __restrict subtract, int width, float* __restrict sum) {
  for (int u = 0; u < width; ++u) {
    sum[u] += add[u] - subtract[u];
  }
}

// Of a row's pixels, over their windows.
struct WindowSums {
  const float* levels;
  const float* squares;
  float per_pixel;  // one over the pixels of a window
};

FLOORLOC_WIDE_VECTORS
void NormalizeRow(const float* __restrict in, const WindowSums& sums, int width, std::uint8_t* __restrict out) {
  const float* __restrict sum = sums.levels;
  const float* __restrict squares = sums.squares;
  const float per_pixel = sums.per_pixel;
  for (int u = 0; u < width; ++u) {
    const float mean = sum[u] * per_pixel;
    const float variance = std::max(squares[u] * per_pixel - mean * mean, kMinDeviation * kMinDeviation);
    const float value = kMiddle + 0.5F + kGain * (in[u] - mean) / std::sqrt(variance);
    out[u] = static_cast<std::uint8_t>(static_cast<int>(std::min(std::max(value, 0.0F), 255.0F)));
  }
}

// Sums over windows of a row, for every pixel, by doubling, which has no dependency between neighbouring pixels. The
// row has a margin of the window's length; powers keeps the partial sums.
class WindowSum {
 public:
  WindowSum(int width, int window) : width_(width), window_(window) {
    powers_.assign(2, Row(static_cast<std::size_t>(width + window)));
  }

  // out[u] = in[u] + ... + in[u + window - 1]
  void Compute(const float* in, float* out) {
    std::fill_n(out, width_, 0.0F);
    const float* sum = in;  // over `length` pixels
    int done = 0;
    int target = 0;
    for (int length = 1; length <= window_; length *= 2) {
      if ((window_ & length) != 0) {
        AddShifted(sum, done, width_, out);
        done += length;
      }
      if (2 * length <= window_) {
        float* next = powers_[static_cast<std::size_t>(target)].data();
        Double(sum, length, width_ + window_ - 2 * length, next);
        sum = next;
        target = 1 - target;
      }
    }
  }

 private:
  int width_;
  int window_;
  std::vector<Row> powers_;
};

// Sums of grey levels and of their squares over the rows' windows.
void SumRows(const cv::Mat& levels, int radius, cv::Mat* sums, cv::Mat* squares) {
  const int width = levels.cols;
  const int window = 2 * radius + 1;
  WindowSum window_sum(width, window);
  Row padded(static_cast<std::size_t>(width + window));
  Row padded_squares(padded.size());
  for (int v = 0; v < levels.rows; ++v) {
    const float* in = levels.ptr<float>(v);
    std::copy(in, in + width, padded.begin() + radius);
    float* const first = padded.data() + radius;
    for (int k = 1; k <= radius; ++k) {
      first[-k] = in[Mirror(-k, width)];
      first[width - 1 + k] = in[Mirror(width - 1 + k, width)];
    }
    Square(padded.data(), static_cast<int>(padded.size()), padded_squares.data());
    window_sum.Compute(padded.data(), sums->ptr<float>(v));
    window_sum.Compute(padded_squares.data(), squares->ptr<float>(v));
  }
}

}  // namespace

void ContrastOptions::Check() const {
  RequireOption(radius_px >= 0 && radius_px <= 512, "radius_px must be 0 to 512");
  RequireOption(smooth_sigma_px >= 0.0 && smooth_sigma_px <= 20.0, "smooth_sigma_px must be 0 (none) to 20");
}

cv::Mat NormalizeContrast(const cv::Mat& gray, const cv::Mat& mask, const ContrastOptions& options) {
  options.Check();
  cv::Mat normalized(gray.size(), CV_8UC1);
  if (gray.empty()) {
    return normalized;
  }
  cv::Mat levels = SmoothGaussian(gray, options.smooth_sigma_px);
  // Small numbers, to avoid cancellation in float when squares of means are subtracted.
  cv::subtract(levels, cv::mean(levels), levels);
  const int height = levels.rows;
  const int width = levels.cols;
  const int radius = options.radius_px;
  cv::Mat row_sums(levels.size(), CV_32F);
  cv::Mat row_squares(levels.size(), CV_32F);
  SumRows(levels, radius, &row_sums, &row_squares);
  Row sum(static_cast<std::size_t>(width), 0.0F);
  Row squares(static_cast<std::size_t>(width), 0.0F);
  for (int k = -radius; k <= radius; ++k) {
    AddShifted(row_sums.ptr<float>(Mirror(k, height)), 0, width, sum.data());
    AddShifted(row_squares.ptr<float>(Mirror(k, height)), 0, width, squares.data());
  }
  const float per_pixel = 1.0F / static_cast<float>((2 * radius + 1) * (2 * radius + 1));
  for (int v = 0; v < height; ++v) {
    NormalizeRow(levels.ptr<float>(v), {sum.data(), squares.data(), per_pixel}, width, normalized.ptr<std::uint8_t>(v));
    const int entering_row = Mirror(v + radius + 1, height);
    const int leaving_row = Mirror(v - radius, height);
    AddDifference(row_sums.ptr<float>(entering_row), row_sums.ptr<float>(leaving_row), width, sum.data());
    AddDifference(row_squares.ptr<float>(entering_row), row_squares.ptr<float>(leaving_row), width, squares.data());
  }
  normalized.setTo(kMiddle, mask == 0);
  return normalized;
}

}  // namespace floorloc
