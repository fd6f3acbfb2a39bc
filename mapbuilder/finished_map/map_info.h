// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/map/floor_map.h"
#include "mapbuilder/finished_map/base_map.h"
#include "mapbuilder/survey/survey_frames.h"

namespace floorloc {

/// What a map that is being made says about itself: id, time, builder, and of each survey camera and provenance, the
/// base map's first. With a base map (nullptr: none) it is a new version of it, and says so.
MapInfo MakeMapInfo(const std::string& name, const std::vector<LoadedSurvey>& surveys, const BaseMap* base_map);

/// The same of a map that is made of two. It is a new version of the first.
MapInfo MakeMergedInfo(const std::string& name, const BaseMap& first, const BaseMap& second);

}  // namespace floorloc
