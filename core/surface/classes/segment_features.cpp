// SPDX-License-Identifier: Apache-2.0
#include "core/surface/classes/segment_features.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "core/geometry/option_check.h"
#include "core/surface/classes/color_features.h"
#include "core/surface/classes/gradient_features.h"
#include "core/surface/classes/pattern_features.h"
#include "core/surface/classes/range_features.h"
#include "core/surface/classes/shape_features.h"

namespace floorloc {
namespace {

bool Asks(const FeatureOptions& options, FeatureGroup group) {
  return std::find(options.groups.begin(), options.groups.end(), group) != options.groups.end();
}

void CountPixels(const Segmentation& segmentation, std::vector<SegmentFeatures>* features) {
  for (int y = 0; y < segmentation.labels.rows; ++y) {
    const int* labels = segmentation.labels.ptr<int>(y);
    for (int x = 0; x < segmentation.labels.cols; ++x) {
      ++(*features)[static_cast<std::size_t>(labels[x])].pixels;
    }
  }
}

void MeasureTexture(const cv::Mat& color, const Segmentation& segmentation, const FeatureOptions& options,
                    std::vector<SegmentFeatures>* features) {
  const bool patterns = Asks(options, FeatureGroup::kPattern);
  const bool gradients = Asks(options, FeatureGroup::kGradient);
  if (!patterns && !gradients) {
    return;
  }
  cv::Mat gray;
  cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
  if (patterns) {
    MeasurePattern(gray, segmentation, options.pattern_threshold, features);
  }
  if (gradients) {
    MeasureGradient(gray, segmentation, features);
  }
}

// Groups that were measured together with one that was asked for.
void DropOthers(const FeatureOptions& options, std::vector<SegmentFeatures>* features) {
  for (std::size_t group = 0; group < kFeatureGroups; ++group) {
    if (!Asks(options, static_cast<FeatureGroup>(group))) {
      for (SegmentFeatures& segment : *features) {
        segment.groups[group].clear();
      }
    }
  }
}

}  // namespace

void FeatureOptions::Check() const {
  RequireOption(!groups.empty(), "groups must not be empty");
  RequireOption(max_intensity > 0.0F && max_intensity <= 65536.0F, "max_intensity must be above 0, up to 65536");
  RequireOption(pattern_threshold >= 0 && pattern_threshold <= 255, "pattern_threshold must be 0 to 255");
}

std::vector<SegmentFeatures> ExtractFeatures(const SurfaceImage& image, const Segmentation& segmentation,
                                             const FeatureOptions& options) {
  std::vector<SegmentFeatures> features(static_cast<std::size_t>(segmentation.count));
  CountPixels(segmentation, &features);
  if (Asks(options, FeatureGroup::kHueSaturation) || Asks(options, FeatureGroup::kValue) ||
      Asks(options, FeatureGroup::kColor)) {
    MeasureColor(image.color, segmentation, &features);
  }
  if (image.has_range() && std::any_of(options.groups.begin(), options.groups.end(), NeedsRange)) {
    MeasureRange(image, segmentation, options.max_intensity, &features);
  }
  if (Asks(options, FeatureGroup::kShape)) {
    MeasureShape(segmentation, options.seed, &features);
  }
  MeasureTexture(image.color, segmentation, options, &features);
  DropOthers(options, &features);
  return features;
}

}  // namespace floorloc
