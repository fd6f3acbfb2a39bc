// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/format_number.h"

#include <cstdio>

namespace floorloc {

std::string FormatNumber(const char* format, double value) {
  char text[160];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

}  // namespace floorloc
