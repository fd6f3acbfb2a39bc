// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/vision/extractors/feature_extractor.h"

namespace floorloc {

/// A row of the benchmark.
struct ExtractorVariant {
  std::string name;
  ExtractorOptions options;
};

/// Every extractor of this build with its defaults, and those that can do with one scale also so.
std::vector<ExtractorVariant> ExtractorVariants();

}  // namespace floorloc
