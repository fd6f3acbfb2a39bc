// SPDX-License-Identifier: Apache-2.0
#include "core/vision/surf/surf_response.h"

#include <algorithm>
#include <cstdint>

#include "core/vision/image/multiversion.h"

namespace floorloc {
namespace {

// Input of the box filters for one row of samples. A filter of side 3 l has three lobes, l by 2 l - 1 pixels each, with
// the weights 1, -2, 1 for the second derivatives, and four lobes, l by l, for the mixed one.
struct RowJob {
  const std::uint32_t* corner;  // the integral image at the corner left and above of the row's first pixel
  std::ptrdiff_t stride;
  int width;  // of the integral image
  int lobe;
  int step_px;
  int first;  // sample
  int count;  // samples
};

// Combinations of rows of the integral image, so that each derivative reads few columns of one row.
struct RowBuffers {
  std::vector<std::uint32_t> xx;
  std::vector<std::uint32_t> yy;
  std::vector<std::uint32_t> xy;
  explicit RowBuffers(int width)
      : xx(static_cast<std::size_t>(width)), yy(static_cast<std::size_t>(width)), xy(static_cast<std::size_t>(width)) {}
};

FLOORLOC_WIDE_VECTORS void CombineRows(const RowJob& job, std::uint32_t* __restrict xx, std::uint32_t* __restrict yy,
                                       std::uint32_t* __restrict xy) {
  const int l = job.lobe;
  const int h = (3 * l - 1) / 2;
  const auto row = [&job](int dy) { return job.corner + dy * job.stride; };
  const std::uint32_t* const xx_top = row(1 - l);
  const std::uint32_t* const xx_bottom = row(l);
  const std::uint32_t* const yy_0 = row(-h);
  const std::uint32_t* const yy_1 = row(l - h);
  const std::uint32_t* const yy_2 = row(2 * l - h);
  const std::uint32_t* const yy_3 = row(h + 1);
  const std::uint32_t* const xy_0 = row(-l);
  const std::uint32_t* const xy_1 = row(0);
  const std::uint32_t* const xy_2 = row(1);
  const std::uint32_t* const xy_3 = row(l + 1);
  for (int x = 0; x < job.width; ++x) {
    xx[x] = xx_bottom[x] - xx_top[x];
    yy[x] = (yy_3[x] - yy_0[x]) - 3 * (yy_2[x] - yy_1[x]);
    xy[x] = (xy_1[x] - xy_0[x]) - (xy_3[x] - xy_2[x]);
  }
}

// kStep 0: the step is that of the job.
template <int kStep>
FLOORLOC_INLINE void Respond(const RowJob& job, const std::uint32_t* __restrict xx, const std::uint32_t* __restrict yy,
                             const std::uint32_t* __restrict xy, float* __restrict out) {
  constexpr float kMixedWeight = 0.81F;  // of the box filters' mixed derivative, squared (Bay et al., section 3.2)
  const int l = job.lobe;
  const int h = (3 * l - 1) / 2;
  const float per_area = 1.0F / static_cast<float>(9 * l * l);
  const std::ptrdiff_t step = kStep == 0 ? job.step_px : kStep;
  const std::ptrdiff_t x0 = job.first * step;
  for (std::ptrdiff_t i = 0; i < job.count; ++i) {
    const std::ptrdiff_t x = x0 + i * step;
    const std::uint32_t sum_xx = (xx[x + h + 1] - xx[x - h]) - 3 * (xx[x - h + 2 * l] - xx[x - h + l]);
    const std::uint32_t sum_yy = yy[x + l] - yy[x - l + 1];
    const std::uint32_t sum_xy = (xy[x] - xy[x - l]) - (xy[x + l + 1] - xy[x + 1]);
    const float d_xx = static_cast<float>(static_cast<std::int32_t>(sum_xx)) * per_area;
    const float d_yy = static_cast<float>(static_cast<std::int32_t>(sum_yy)) * per_area;
    const float d_xy = static_cast<float>(static_cast<std::int32_t>(sum_xy)) * per_area;
    out[i] = d_xx * d_yy - kMixedWeight * d_xy * d_xy;
  }
}

FLOORLOC_WIDE_VECTORS void RespondRow(const RowJob& job, const RowBuffers& buffers, float* out) {
  const std::uint32_t* const xx = buffers.xx.data();
  const std::uint32_t* const yy = buffers.yy.data();
  const std::uint32_t* const xy = buffers.xy.data();
  if (job.step_px == 1) {
    Respond<1>(job, xx, yy, xy, out);
  } else if (job.step_px == 2) {
    Respond<2>(job, xx, yy, xy, out);
  } else {
    Respond<0>(job, xx, yy, xy, out);
  }
}

ResponseLayer EmptyLayer(int filter_px, int step_px, const cv::Mat& response) {
  return {filter_px, step_px, (filter_px / 2 + step_px - 1) / step_px, response};
}

// Number of samples from the margin to the last one where a filter of this half side fits.
int FittingSamples(int side_px, int half_px, const ResponseLayer& layer) {
  return (side_px - 1 - half_px) / layer.step_px - layer.margin + 1;
}

void FillLayer(const IntegralImage& integral, ResponseLayer* filled) {
  ResponseLayer& layer = *filled;
  layer.response = 0.0F;
  const int step_px = layer.step_px;
  const int half = layer.filter_px / 2;
  const int count = FittingSamples(integral.width(), half, layer);
  const int rows = FittingSamples(integral.height(), half, layer);
  RowBuffers buffers(integral.width() + 1);
  for (int j = layer.margin; j < layer.margin + rows && count > 0; ++j) {
    const RowJob job{integral.row(j * step_px),
                     integral.stride(),
                     integral.width() + 1,
                     layer.filter_px / 3,
                     step_px,
                     layer.margin,
                     count};
    CombineRows(job, buffers.xx.data(), buffers.yy.data(), buffers.xy.data());
    RespondRow(job, buffers, layer.response.ptr<float>(j) + layer.margin);
  }
}

// Every second sample of every second row.
void Decimate(const ResponseLayer& fine, ResponseLayer* layer) {
  for (int j = 0; j < layer->response.rows; ++j) {
    const float* const from = fine.row(2 * j);
    float* const to = layer->response.ptr<float>(j);
    for (int i = 0; i < layer->response.cols; ++i) {
      to[i] = from[2 * i];
    }
  }
}

}  // namespace

ResponseOctave ComputeOctave(const IntegralImage& integral, int octave, int layers, const ResponseOctave& previous,
                             int first_step_px) {
  ResponseOctave result;
  const int step_px = first_step_px << octave;
  const int rows = std::max(integral.height() - 1, 0) / step_px + 1;
  // One block for all layers: smaller ones would be returned to the system when freed, which costs time.
  const cv::Mat block(layers * rows, std::max(integral.width() - 1, 0) / step_px + 1, CV_32FC1);
  const int side_px = std::min(integral.width(), integral.height());
  for (int i = 1; i <= layers; ++i) {
    const int filter_px = 3 * ((2 << octave) * i + 1);
    if (filter_px > side_px) {
      break;
    }
    result.push_back(EmptyLayer(filter_px, step_px, block.rowRange((i - 1) * rows, i * rows)));
    const auto shared = std::find_if(previous.begin(), previous.end(),
                                     [filter_px](const ResponseLayer& layer) { return layer.filter_px == filter_px; });
    if (shared != previous.end()) {
      Decimate(*shared, &result.back());
    } else {
      FillLayer(integral, &result.back());
    }
  }
  return result;
}

float LaplacianAt(const IntegralImage& integral, int filter_px, int x, int y) {
  const int l = filter_px / 3;
  const int h = filter_px / 2;
  const auto box = [&integral](int left, int top, int right, int bottom) {
    const std::uint32_t* const upper = integral.row(top);
    const std::uint32_t* const lower = integral.row(bottom);
    return static_cast<float>(static_cast<std::int32_t>(lower[right] - lower[left] - upper[right] + upper[left]));
  };
  const float d_xx = box(x - h, y - l + 1, x + h + 1, y + l) - 3.0F * box(x - h + l, y - l + 1, x - h + 2 * l, y + l);
  const float d_yy = box(x - l + 1, y - h, x + l, y + h + 1) - 3.0F * box(x - l + 1, y - h + l, x + l, y - h + 2 * l);
  return d_xx + d_yy;
}

}  // namespace floorloc
