// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "mapbuilder/report/quality.h"

namespace floorloc {

/// "too few keypoints"
const char* Name(Weakness weakness);
/// One word for files and style sheets, e.g. "few_keypoints".
const char* Key(Weakness weakness);
/// What to do about it, in the imperative.
const char* Advice(const Zone& zone);
/// What was found there, with its numbers.
std::string Describe(const Zone& zone);

}  // namespace floorloc
