// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/serving/map_catalog.h"
#include "server/serving/map_library.h"
#include "server/serving/success_map.h"

namespace floorloc {

/// {"maps":[...]}
std::string FormatMapList(const std::vector<std::shared_ptr<const LoadedMap>>& maps, const MapLibrary& library);
/// One map with its build parameters and versions.
std::string FormatMap(const LoadedMap& map, const MapLibrary& library);
/// {"map","active","previous","versions":[...]}, the newest version first.
std::string FormatVersions(const LoadedMap& map, const MapLibrary& library);
/// active: content version that is.
std::string FormatVersion(const MapVersion& version, const std::string& active);
std::string FormatActivation(const MapChange& change);
/// The build report stored in the map; {} when it has none.
/// The answer of GET /v1/maps/{map}/success.
std::string FormatSuccess(const LoadedMap& map, const SuccessMap& counted);
std::string FormatReport(const LoadedMap& map);
/// Per square metre of floor: keypoints, and how good they are.
std::string FormatQuality(const LoadedMap& map);

}  // namespace floorloc
