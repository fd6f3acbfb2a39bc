// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "core/vision/extractors/feature_extractor.h"

namespace floorloc {

/// Features of OpenCV's detectors and descriptors, and of SURF, which has the same interface.
std::unique_ptr<FeatureExtractor> CreateOpenCvExtractor(const ExtractorOptions& options);

}  // namespace floorloc
