// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "core/localization/localizer.h"
#include "core/map/map_database.h"
#include "mapbuilder/batch/progress.h"
#include "tests/bench/scenes/cases.h"
#include "tests/bench/scenes/gray_renderer.h"

namespace floorloc {

/// Where the benchmark keeps a floor's images, survey and map.
struct FloorFiles {
  std::filesystem::path folder;
  std::string name;

  std::filesystem::path Survey() const { return folder / (name + "-survey"); }
  std::filesystem::path Map() const { return folder / (name + ".floormap"); }
  /// The floor when the share `wear` of it has changed.
  std::filesystem::path ImageFile(double wear) const;
};

/// Makes the floor, its worn variants and a survey of its left part. Throws InputError when they can't be written.
void MakeFloor(const FloorFiles& files, const FloorCase& floor_case);

/// MakeFloor and the map of the survey; nothing when the map is there. Throws what the builder throws.
void PrepareFloor(const FloorFiles& files, const FloorCase& floor_case, const ProgressOutput& progress);

/// Throws InputError when the file is not there.
GrayFloor ReadGrayFloor(const FloorFiles& files, double wear);

/// A floor with its map.
struct BenchFloor {
  std::unique_ptr<MapDatabase> database;  ///< of the mosaic, which the localizer reads
  std::unique_ptr<Localizer> localizer;
  Pose2 map_from_truth;          ///< by the map's own frames
  double map_rms_m = 0.0;        ///< position error of the map's own frames after that
  std::vector<GrayFloor> looks;  ///< one per condition case
};

BenchFloor ReadBenchFloor(const FloorFiles& files, const std::vector<ConditionCase>& conditions);

}  // namespace floorloc
