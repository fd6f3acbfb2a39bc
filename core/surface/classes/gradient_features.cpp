// SPDX-License-Identifier: Apache-2.0
#include "core/surface/classes/gradient_features.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace floorloc {
namespace {

constexpr int kScales = 3;
constexpr float kFlat = 2.0F;  // grey levels between the neighbours on both sides

struct GradientSums {
  float count = 0.0F;
  float flat = 0.0F;
  float magnitude = 0.0F;
  float square = 0.0F;
  float cos2 = 0.0F, sin2 = 0.0F;  // of twice the direction, weighted by the square
  float cos4 = 0.0F, sin4 = 0.0F;

  void Add(float dx, float dy) {
    const float power = dx * dx + dy * dy;
    const float strength = std::sqrt(power);
    const float c2 = dx * dx - dy * dy;
    const float s2 = 2.0F * dx * dy;
    const float inverse = power > 0.0F ? 1.0F / power : 0.0F;
    count += 1.0F;
    flat += strength < kFlat ? 1.0F : 0.0F;
    magnitude += strength;
    square += power;
    cos2 += c2;
    sin2 += s2;
    cos4 += (c2 * c2 - s2 * s2) * inverse;
    sin4 += 2.0F * c2 * s2 * inverse;
  }

  void AppendTo(std::vector<float>* numbers) const {
    const float n = std::max(count, 1.0F);
    const float mean = magnitude / n;
    const bool any = square > 0.0F;
    numbers->push_back(std::log(1.0F + mean));
    numbers->push_back(any ? std::log(square / n / (mean * mean)) : 0.0F);
    numbers->push_back(any ? std::hypot(cos2, sin2) / square : 0.0F);
    numbers->push_back(any ? std::hypot(cos4, sin4) / square : 0.0F);
    numbers->push_back(flat / n);
  }
};

// gray: reduced by 2^scale, whose pixel (x, y) belongs to the segment of pixel (x, y) * 2^scale.
void Sum(const cv::Mat& gray, const cv::Mat& labels, int scale, std::vector<GradientSums>* sums) {
  for (int y = 1; y + 1 < gray.rows; ++y) {
    const auto* above = gray.ptr<std::uint8_t>(y - 1);
    const auto* row = gray.ptr<std::uint8_t>(y);
    const auto* below = gray.ptr<std::uint8_t>(y + 1);
    const int* label = labels.ptr<int>(std::min(y << scale, labels.rows - 1));
    for (int x = 1; x + 1 < gray.cols; ++x) {
      (*sums)[static_cast<std::size_t>(label[std::min(x << scale, labels.cols - 1)])].Add(
          static_cast<float>(row[x + 1] - row[x - 1]), static_cast<float>(below[x] - above[x]));
    }
  }
}

}  // namespace

void MeasureGradient(const cv::Mat& gray, const Segmentation& segmentation, std::vector<SegmentFeatures>* features) {
  cv::Mat reduced = gray;
  for (int scale = 0; scale < kScales; ++scale) {
    if (scale > 0) {
      cv::Mat half;
      cv::pyrDown(reduced, half);
      reduced = half;
    }
    std::vector<GradientSums> sums(features->size());
    Sum(reduced, segmentation.labels, scale, &sums);
    for (std::size_t i = 0; i < sums.size(); ++i) {
      sums[i].AppendTo(&(*features)[i].groups[static_cast<std::size_t>(FeatureGroup::kGradient)]);
    }
  }
}

}  // namespace floorloc
