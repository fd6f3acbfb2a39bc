// SPDX-License-Identifier: Apache-2.0
#include "core/vision/extractors/feature_extractor.h"

#include <stdexcept>

#include "core/vision/extractors/hessian_extractor.h"
#include "core/vision/extractors/opencv_extractor.h"
#include "core/vision/extractors/surf_feature.h"
#include "core/vision/image/contrast.h"

namespace floorloc {
namespace {

void Require(bool ok, const char* message) {
  if (!ok) {
    throw std::invalid_argument(message);
  }
}

}  // namespace

cv::Mat FeatureExtractor::Prepare(const GroundImage& image) const {
  if (options_.normalize_radius_px == 0) {
    return image.gray;
  }
  return NormalizeContrast(image.gray, image.mask, {options_.normalize_radius_px, options_.smooth_sigma_px});
}

ContrastOptions ContrastOfMosaic(const ExtractorOptions& options) {
  const int radius_px = options.normalize_radius_px > 0 ? options.normalize_radius_px : ContrastOptions().radius_px;
  return {radius_px, options.smooth_sigma_px};
}

const char* ToString(ExtractorType type) {
  switch (type) {
    case ExtractorType::kHessian:
      return "hessian";
    case ExtractorType::kOrb:
      return "orb";
    case ExtractorType::kSift:
      return "sift";
    case ExtractorType::kAkaze:
      return "akaze";
    case ExtractorType::kBrisk:
      return "brisk";
    case ExtractorType::kSurf:
      return "surf";
  }
  return "unknown";
}

std::vector<ExtractorType> AllExtractorTypes() {
  std::vector<ExtractorType> types{ExtractorType::kHessian, ExtractorType::kOrb, ExtractorType::kSift,
                                   ExtractorType::kAkaze, ExtractorType::kBrisk};
  if (SurfAvailable()) {
    types.push_back(ExtractorType::kSurf);
  }
  return types;
}

ExtractorType ParseExtractorType(const std::string& name) {
  // Also parsed in builds without SURF, which can show maps built with it and report why they cannot extract it.
  if (name == ToString(ExtractorType::kSurf)) {
    return ExtractorType::kSurf;
  }
  std::string known;
  for (const ExtractorType type : AllExtractorTypes()) {
    if (name == ToString(type)) {
      return type;
    }
    known += std::string(known.empty() ? "" : ", ") + ToString(type);
  }
  throw std::invalid_argument("unknown extractor '" + name + "'; known are: " + known);
}

void ExtractorOptions::Check() const {
  Require(max_keypoints >= 10 && max_keypoints <= 100000, "max_keypoints must be 10 to 100000");
  Require(cell_px >= 4 && cell_px <= 4096, "cell_px must be 4 to 4096");
  Require(levels >= 1 && levels <= 8, "levels must be 1 to 8");
  Require(scale_factor > 1.0 && scale_factor <= 4.0, "scale_factor must be above 1 and at most 4");
  Require(threshold >= 0.0 && threshold <= 255.0, "threshold must be 0 (automatic) to 255");
  Require(normalize_radius_px >= 0 && normalize_radius_px <= 512, "normalize_radius_px must be 0 (none) to 512");
  Require(smooth_sigma_px >= 0.0 && smooth_sigma_px <= 20.0, "smooth_sigma_px must be 0 (none) to 20");
}

std::unique_ptr<FeatureExtractor> CreateFeatureExtractor(const ExtractorOptions& options) {
  options.Check();
  return options.type == ExtractorType::kHessian ? CreateHessianExtractor(options) : CreateOpenCvExtractor(options);
}

}  // namespace floorloc
