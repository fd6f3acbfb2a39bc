// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/map/floor_map.h"

namespace floorloc {

/// Provenance of a survey as stored in a map.
struct SurveyProvenance {
  std::string folder;  ///< name
  std::string camera;  ///< name
  std::int64_t frames = 0;
  bool odometry = false;
  std::string mounting;  ///< where floor.yaml comes from; empty: it does not say
};

/// One per survey of the map; values missing in surveys_json keep their defaults. Throws MapError when it has a form
/// that the builder does not write.
std::vector<SurveyProvenance> ReadProvenance(const MapInfo& info);

}  // namespace floorloc
