// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "mapbuilder/build_map.h"

namespace floorloc {

/// The report as JSON, for `--json` and the map's report_json. Times are left out of the latter, so that equal input
/// gives equal files.
std::string ToJson(const BuildReport& report, bool with_times);

/// The summary that people read.
std::string ToText(const BuildReport& report);

}  // namespace floorloc
