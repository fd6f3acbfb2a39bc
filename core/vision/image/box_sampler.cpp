// SPDX-License-Identifier: Apache-2.0
#include "core/vision/image/box_sampler.h"

#include <algorithm>
#include <cstdint>

#include "core/vision/image/multiversion.h"

namespace floorloc {
namespace {

constexpr float kUnit = 256.0F;  // fixed point of the smoothed images: 8 integer and 8 fractional bits

// Means of the squares whose upper left pixels are x and, in the upper half of the word, x + 1.
FLOORLOC_WIDE_VECTORS void SmoothRow(const std::uint32_t* __restrict top, const std::uint32_t* __restrict bottom,
                                     int box, int count, std::uint32_t* __restrict means) {
  const float factor = kUnit / static_cast<float>(box * box);
  for (int x = 0; x < count; ++x) {
    const std::uint32_t sum = bottom[x + box] - bottom[x] - top[x + box] + top[x];
    means[x] = static_cast<std::uint32_t>(static_cast<std::int32_t>(static_cast<float>(sum) * factor));
  }
  for (int x = 0; x + 1 < count; ++x) {
    means[x] |= means[x + 1] << 16;
  }
}

void Smooth(const IntegralImage& integral, int box, cv::Mat* means) {
  for (int y = 0; y < means->rows; ++y) {
    SmoothRow(integral.row(y), integral.row(y + box), box, means->cols,
              reinterpret_cast<std::uint32_t*>(means->ptr(y)));
  }
}

// Pattern, pose and image of one call.
struct Sampling {
  const float* u;
  const float* v;
  int count;
  cv::Point2f first;  // the upper left pixel of the square at the pattern's origin
  cv::Point2f axis;
  int box;
  const std::uint32_t* data;
  int stride;
  int last_x;
  int last_y;
};

FLOORLOC_INLINE float Lerp(float a, float b, float t) { return a + t * (b - a); }

FLOORLOC_WIDE_VECTORS void SampleSmoothed(const Sampling& s, float* __restrict means) {
  const std::uint32_t* __restrict const data = s.data;
  for (int i = 0; i < s.count; ++i) {
    const float x = s.first.x + s.u[i] * s.axis.x - s.v[i] * s.axis.y;
    const float y = s.first.y + s.u[i] * s.axis.y + s.v[i] * s.axis.x;
    const int left = std::min(std::max(static_cast<int>(x), 0), s.last_x);
    const int top = std::min(std::max(static_cast<int>(y), 0), s.last_y);
    const float right_part = std::min(std::max(x - static_cast<float>(left), 0.0F), 1.0F);
    const float lower_part = std::min(std::max(y - static_cast<float>(top), 0.0F), 1.0F);
    const std::uint32_t upper = data[top * s.stride + left];
    const std::uint32_t lower = data[top * s.stride + left + s.stride];
    const auto upper_left = static_cast<float>(static_cast<std::int32_t>(upper & 0xffffU));
    const auto upper_right = static_cast<float>(static_cast<std::int32_t>(upper >> 16));
    const auto lower_left = static_cast<float>(static_cast<std::int32_t>(lower & 0xffffU));
    const auto lower_right = static_cast<float>(static_cast<std::int32_t>(lower >> 16));
    means[i] = (1.0F / kUnit) *
               Lerp(Lerp(upper_left, upper_right, right_part), Lerp(lower_left, lower_right, right_part), lower_part);
  }
}

FLOORLOC_WIDE_VECTORS void SampleRounded(const Sampling& s, float* __restrict means) {
  const std::uint32_t* __restrict const data = s.data;
  const int box = s.box;
  const float factor = 1.0F / static_cast<float>(box * box);
  for (int i = 0; i < s.count; ++i) {
    const float x = s.first.x + s.u[i] * s.axis.x - s.v[i] * s.axis.y + 0.5F;
    const float y = s.first.y + s.u[i] * s.axis.y + s.v[i] * s.axis.x + 0.5F;
    const int left = std::min(std::max(static_cast<int>(x), 0), s.last_x);
    const int top = std::min(std::max(static_cast<int>(y), 0), s.last_y);
    const int upper = top * s.stride + left;
    const int lower = upper + box * s.stride;
    const std::uint32_t sum = data[lower + box] - data[lower] - data[upper + box] + data[upper];
    means[i] = static_cast<float>(static_cast<std::int32_t>(sum)) * factor;
  }
}

}  // namespace

SamplePattern SquareGrid(int side) {
  SamplePattern grid;
  const float center = 0.5F * static_cast<float>(side - 1);
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      grid.u.push_back(static_cast<float>(i) - center);
      grid.v.push_back(static_cast<float>(j) - center);
    }
  }
  return grid;
}

cv::Mat BoxSampler::SmoothedRows(int box) {
  cv::Mat& smoothed = smoothed_[static_cast<std::size_t>(box)];
  if (smoothed.empty()) {
    if (block_.empty()) {
      block_.create(kWidestSmoothed * integral_.height(), integral_.width(), CV_32SC1);
    }
    const int first = (box - 1) * integral_.height();
    smoothed = block_(cv::Rect(0, first, integral_.width() - box + 1, integral_.height() - box + 1));
    Smooth(integral_, box, &smoothed);
  }
  return smoothed;
}

void BoxSampler::Sample(const SamplePattern& pattern, const SamplePatternPose& pose, float* means) {
  const int widest = std::min(integral_.width(), integral_.height()) - 1;
  if (widest < 1) {
    std::fill_n(means, pattern.u.size(), 0.0F);
    return;
  }
  const int box = std::clamp(pose.box_px, 1, widest);
  const float to_corner = -0.5F * static_cast<float>(box - 1);
  Sampling sampling{pattern.u.data(),
                    pattern.v.data(),
                    static_cast<int>(pattern.u.size()),
                    pose.center + cv::Point2f(to_corner, to_corner),
                    pose.u_axis,
                    box,
                    integral_.data(),
                    static_cast<int>(integral_.stride()),
                    integral_.width() - box,
                    integral_.height() - box};
  if (box > kWidestSmoothed) {
    SampleRounded(sampling, means);
    return;
  }
  const cv::Mat smoothed = SmoothedRows(box);
  sampling.data = reinterpret_cast<const std::uint32_t*>(smoothed.ptr());
  sampling.stride = static_cast<int>(smoothed.step1());
  --sampling.last_x;
  --sampling.last_y;
  SampleSmoothed(sampling, means);
}

}  // namespace floorloc
