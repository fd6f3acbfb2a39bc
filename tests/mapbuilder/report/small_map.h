// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "core/map/map_database.h"
#include "mapbuilder/build/build_map.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {

/// A survey of the synthetic floor and its coarse map, built once per process.
class SmallMap {
 public:
  static const SmallMap& Get() {
    static const SmallMap map;
    return map;
  }

  std::filesystem::path survey() const { return folder_.path() / "survey"; }
  std::filesystem::path file() const { return folder_.path() / "floor.floormap"; }

 private:
  SmallMap() {
    SyntheticFloor(1).WriteSurvey(survey());
    BuildOptions options;
    options.surveys = {survey()};
    options.out = file();
    options.mosaic.resolution_m = 0.0056;  // coarse is fast
    BuildMap(options);
  }

  TemporaryFolder folder_;
};

}  // namespace floorloc
