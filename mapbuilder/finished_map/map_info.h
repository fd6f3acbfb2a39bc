// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/map/floor_map.h"
#include "mapbuilder/finished_map/base_map.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

/// Metadata of a map being built: id, time, builder, and camera and provenance of each survey, those of the base map
/// first. With a base map (nullptr: none) it is marked as a new version of it.
MapInfo MakeMapInfo(const std::string& name, const std::vector<LoadedSurvey>& surveys, const BaseMap* base_map);

/// The same for a merged map, which is a new version of the first.
MapInfo MakeMergedInfo(const std::string& name, const BaseMap& first, const BaseMap& second);

}  // namespace floorloc
