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

/// All extractors of this build with their defaults; those that work on a single scale also with one.
std::vector<ExtractorVariant> ExtractorVariants();

}  // namespace floorloc
