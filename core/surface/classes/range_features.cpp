// SPDX-License-Identifier: Apache-2.0
#include "core/surface/classes/range_features.h"

#include <algorithm>

#include "core/surface/classes/moments.h"

namespace floorloc {
namespace {

constexpr int kBins = 25;

struct RangeSums {
  std::array<int, kBins> intensity = {};
  Moments<2> moments;  // depth in metres, intensity
};

int BinOf(float intensity, float max_intensity) {
  return std::clamp(static_cast<int>(kBins * intensity / max_intensity), 0, kBins - 1);
}

}  // namespace

void MeasureRange(const SurfaceImage& image, const Segmentation& segmentation, float max_intensity,
                  std::vector<SegmentFeatures>* features) {
  std::vector<RangeSums> sums(features->size());
  for (int y = 0; y < image.depth_mm.rows; ++y) {
    const auto* depth = image.depth_mm.ptr<std::uint16_t>(y);
    const auto* intensity = image.intensity.ptr<std::uint16_t>(y);
    const int* labels = segmentation.labels.ptr<int>(y);
    for (int x = 0; x < image.depth_mm.cols; ++x) {
      if (depth[x] > 0) {
        RangeSums& segment = sums[static_cast<std::size_t>(labels[x])];
        ++segment.intensity[static_cast<std::size_t>(BinOf(intensity[x], max_intensity))];
        segment.moments.Add({1e-3 * depth[x], static_cast<double>(intensity[x])});
      }
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const int seen = sums[i].moments.count();
    if (seen == 0) {
      continue;
    }
    auto& groups = (*features)[i].groups;
    groups[static_cast<std::size_t>(FeatureGroup::kDepthIntensity)] = sums[i].moments.MeanAndCovariance();
    auto& histogram = groups[static_cast<std::size_t>(FeatureGroup::kIntensity)];
    for (const int count : sums[i].intensity) {
      histogram.push_back(static_cast<float>(count) / static_cast<float>(seen));
    }
  }
}

}  // namespace floorloc
