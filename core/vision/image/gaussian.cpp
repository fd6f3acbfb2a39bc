// SPDX-License-Identifier: Apache-2.0
#include "core/vision/image/gaussian.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/vision/image/mirror.h"
#include "core/vision/image/multiversion.h"

namespace floorloc {
namespace {

// weights[k] is for the pixels at distance k on either side.
std::vector<float> HalfKernel(double sigma_px) {
  const int radius = static_cast<int>(std::ceil(3.0 * sigma_px));
  std::vector<double> kernel;
  double sum = 0.0;
  for (int k = 0; k <= radius; ++k) {
    kernel.push_back(std::exp(-0.5 * k * k / (sigma_px * sigma_px)));
    sum += k == 0 ? kernel.back() : 2.0 * kernel.back();
  }
  std::vector<float> weights;
  for (const double w : kernel) {
    weights.push_back(static_cast<float>(w / sum));
  }
  return weights;
}

FLOORLOC_WIDE_VECTORS
void Scale(const float* __restrict in, float weight, int width, float* __restrict out) {
  for (int u = 0; u < width; ++u) {
    out[u] = weight * in[u];
  }
}

// Pixels at the same distance on either side.
struct Pair {
  const float* before;
  const float* after;
  float weight;
};

FLOORLOC_WIDE_VECTORS
void AddPair(const Pair& pair, int width, float* __restrict out) {
  const float* const before = pair.before;
  const float* const after = pair.after;
  const float weight = pair.weight;
  for (int u = 0; u < width; ++u) {
    out[u] += weight * (before[u] + after[u]);
  }
}

// Three at a time: most of the time of a short sum is reading and writing it.
FLOORLOC_WIDE_VECTORS
void AddThreePairs(const Pair* pairs, int width, float* __restrict out) {
  const Pair a = pairs[0];
  const Pair b = pairs[1];
  const Pair c = pairs[2];
  for (int u = 0; u < width; ++u) {
    float sum = out[u] + a.weight * (a.before[u] + a.after[u]);
    sum += b.weight * (b.before[u] + b.after[u]);
    out[u] = sum + c.weight * (c.before[u] + c.after[u]);
  }
}

void AddPairs(const std::vector<Pair>& pairs, int width, float* out) {
  std::size_t i = 0;
  for (; i + 3 <= pairs.size(); i += 3) {
    AddThreePairs(&pairs[i], width, out);
  }
  for (; i < pairs.size(); ++i) {
    AddPair(pairs[i], width, out);
  }
}

}  // namespace

cv::Mat SmoothGaussian(const cv::Mat& image, double sigma_px) {
  cv::Mat levels;
  image.convertTo(levels, CV_32F);
  if (sigma_px <= 0.0 || image.empty()) {
    return levels;
  }
  const std::vector<float> weights = HalfKernel(sigma_px);
  const int radius = static_cast<int>(weights.size()) - 1;
  const int width = levels.cols;
  cv::Mat smooth(levels.size(), CV_32F);
  // A column pass into a row with margins, then the row pass.
  std::vector<float> row(static_cast<std::size_t>(width + 2 * radius));
  float* middle = row.data() + radius;
  std::vector<Pair> above_below(weights.size() - 1);
  std::vector<Pair> left_right;
  for (int k = 1; k <= radius; ++k) {
    left_right.push_back({middle - k, middle + k, weights[static_cast<std::size_t>(k)]});
  }
  for (int v = 0; v < levels.rows; ++v) {
    for (int k = 1; k <= radius; ++k) {
      above_below[static_cast<std::size_t>(k - 1)] = {levels.ptr<float>(Mirror(v - k, levels.rows)),
                                                      levels.ptr<float>(Mirror(v + k, levels.rows)),
                                                      weights[static_cast<std::size_t>(k)]};
    }
    Scale(levels.ptr<float>(v), weights[0], width, middle);
    AddPairs(above_below, width, middle);
    for (int k = 1; k <= radius; ++k) {
      middle[-k] = middle[Mirror(-k, width)];
      middle[width - 1 + k] = middle[Mirror(width - 1 + k, width)];
    }
    float* out = smooth.ptr<float>(v);
    Scale(middle, weights[0], width, out);
    AddPairs(left_right, width, out);
  }
  return smooth;
}

}  // namespace floorloc
