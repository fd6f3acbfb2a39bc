// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "core/vision/extractors/feature_extractor.h"

namespace floorloc {

/// Features of one scale for floors, whose scale is known: blobs by the determinant of the Hessian, described by
/// steered BRIEF. options.threshold: least determinant, (grey levels)^2 of the contrast-normalised image.
std::unique_ptr<FeatureExtractor> CreateHessianExtractor(const ExtractorOptions& options);

}  // namespace floorloc
