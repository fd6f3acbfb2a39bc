// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/serving/map_catalog.h"

namespace floorloc {

/// {"maps":[...]}
std::string FormatMapList(const std::vector<std::shared_ptr<const LoadedMap>>& maps);
/// One map with its build parameters.
std::string FormatMap(const LoadedMap& map);
/// The build report stored in the map; {} when it has none.
std::string FormatReport(const LoadedMap& map);
/// Per square metre of floor: keypoints, and how good they are.
std::string FormatQuality(const LoadedMap& map);

}  // namespace floorloc
