// SPDX-License-Identifier: Apache-2.0
#include "core/vision/extractors/extractor_layout.h"

#include <stdexcept>

#include "core/vision/extractors/steered_brief.h"
#include "core/vision/surf/surf.h"

namespace floorloc {

DescriptorLayout LayoutOf(ExtractorType type) {
  switch (type) {
    case ExtractorType::kHessian:
      return {DescriptorType::kBinary, kBriefBytes};
    case ExtractorType::kOrb:
      return {DescriptorType::kBinary, 32};
    case ExtractorType::kSift:
      return {DescriptorType::kFloat, 128};
    case ExtractorType::kAkaze:
      return {DescriptorType::kBinary, 61};
    case ExtractorType::kBrisk:
      return {DescriptorType::kBinary, 64};
    case ExtractorType::kSurf:
      return {DescriptorType::kFloat, kSurfLength};
  }
  throw std::invalid_argument("unknown extractor");
}

bool HasUpright(ExtractorType type) { return type == ExtractorType::kHessian; }

}  // namespace floorloc
