// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>
#include <string>

namespace floorloc {

inline double ToDegrees(double rad) { return rad * 180.0 / std::numbers::pi; }

/// A number in a sentence. format: as of printf, with one place for a double.
std::string FormatNumber(const char* format, double value);

}  // namespace floorloc
