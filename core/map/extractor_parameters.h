// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "core/vision/extractors/feature_extractor.h"

namespace floorloc {

/// The options as name -> text, one entry per field, exact (numbers in shortest round-trip form).
std::map<std::string, std::string> ToParameters(const ExtractorOptions& options);

/// The inverse. Throws std::invalid_argument when a parameter is missing, unknown (written by a newer version) or
/// out of range.
ExtractorOptions FromParameters(const std::map<std::string, std::string>& parameters);

}  // namespace floorloc
