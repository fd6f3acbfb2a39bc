// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/map/floor_map.h"

namespace floorloc {

/// What a map says of a survey that it was made from.
struct SurveyProvenance {
  std::string folder;  ///< name
  std::string camera;  ///< name
  std::int64_t frames = 0;
  bool odometry = false;
};

/// One per survey of the map; what its surveys_json does not say keeps its default. Throws MapError when it says
/// something else than the builder writes.
std::vector<SurveyProvenance> ReadProvenance(const MapInfo& info);

}  // namespace floorloc
