// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/extractors/extractor_variant.h"

namespace floorloc {
namespace {

// AKAZE and BRISK need neighbouring scales. OpenCV's SIFT always uses all octaves, regardless of the options.
bool WorksOnOneScale(ExtractorType type) { return type == ExtractorType::kOrb || type == ExtractorType::kSurf; }

}  // namespace

std::vector<ExtractorVariant> ExtractorVariants() {
  std::vector<ExtractorVariant> variants;
  for (const ExtractorType type : AllExtractorTypes()) {
    ExtractorOptions options;
    options.type = type;
    variants.push_back({ToString(type), options});
    if (WorksOnOneScale(type)) {
      options.levels = 1;
      const char* scale = type == ExtractorType::kOrb ? ", 1 level" : ", 1 octave";
      variants.push_back({std::string(ToString(type)) + scale, options});
    }
  }
  return variants;
}

}  // namespace floorloc
