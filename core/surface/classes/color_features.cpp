// SPDX-License-Identifier: Apache-2.0
#include "core/surface/classes/color_features.h"

#include <opencv2/imgproc.hpp>

#include "core/surface/classes/moments.h"

namespace floorloc {
namespace {

constexpr int kBinsOfHue = 4;
constexpr int kBinsOfSaturation = 4;
constexpr int kBinsOfValue = 8;
constexpr int kHues = 180;  // OpenCV's hue in 8 bits: half degrees

struct ColorSums {
  std::array<int, kBinsOfHue* kBinsOfSaturation> hue_saturation = {};
  std::array<int, kBinsOfValue> value = {};
  Moments<3> moments;

  void Add(const cv::Vec3b& hsv) {
    const int hue = hsv[0] * kBinsOfHue / kHues;
    const int saturation = hsv[1] * kBinsOfSaturation / 256;
    const int bin = hue * kBinsOfSaturation + saturation;
    ++hue_saturation[static_cast<std::size_t>(bin)];
    ++value[static_cast<std::size_t>(hsv[2] * kBinsOfValue / 256)];
    moments.Add({static_cast<double>(hsv[0]), static_cast<double>(hsv[1]), static_cast<double>(hsv[2])});
  }
};

template <std::size_t N>
std::vector<float> Shares(const std::array<int, N>& counts, int total) {
  std::vector<float> shares;
  for (const int count : counts) {
    shares.push_back(static_cast<float>(count) / static_cast<float>(total));
  }
  return shares;
}

}  // namespace

void MeasureColor(const cv::Mat& color, const Segmentation& segmentation, std::vector<SegmentFeatures>* features) {
  cv::Mat hsv;
  cv::cvtColor(color, hsv, cv::COLOR_BGR2HSV);
  std::vector<ColorSums> sums(features->size());
  for (int y = 0; y < hsv.rows; ++y) {
    const auto* pixels = hsv.ptr<cv::Vec3b>(y);
    const int* labels = segmentation.labels.ptr<int>(y);
    for (int x = 0; x < hsv.cols; ++x) {
      sums[static_cast<std::size_t>(labels[x])].Add(pixels[x]);
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    auto& groups = (*features)[i].groups;
    const int pixels = sums[i].moments.count();
    groups[static_cast<std::size_t>(FeatureGroup::kHueSaturation)] = Shares(sums[i].hue_saturation, pixels);
    groups[static_cast<std::size_t>(FeatureGroup::kValue)] = Shares(sums[i].value, pixels);
    groups[static_cast<std::size_t>(FeatureGroup::kColor)] = sums[i].moments.MeanAndCovariance();
  }
}

}  // namespace floorloc
