// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "mapbuilder/report/quality.h"

namespace floorloc {

/// Readable name, e.g. "too few keypoints".
const char* Name(Weakness weakness);
/// Identifier for files and style sheets, e.g. "few_keypoints".
const char* Key(Weakness weakness);
/// Recommended action, in the imperative.
const char* Advice(const Zone& zone);
/// Description of the zone with its numbers.
std::string Describe(const Zone& zone);

}  // namespace floorloc
