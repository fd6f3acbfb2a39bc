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

/// The camera that takes the benchmark's images, and its calibration, which is a little wrong as every one.
FloorCamera BenchCamera();
FloorCamera BenchCalibration();

/// Paths of a floor's images, survey and map.
struct FloorFiles {
  std::filesystem::path folder;
  std::string name;
  double resolution_m = FloorTextureOptions().resolution_m;  ///< FloorTextureOptions::resolution_m of its images

  std::filesystem::path Survey() const { return folder / (name + "-survey"); }
  std::filesystem::path Map() const { return folder / (name + ".floormap"); }
  /// The floor after a share `wear` of it has changed.
  std::filesystem::path ImageFile(double wear) const;
};

/// Makes the floor, its worn variants and a survey of its left part. Throws InputError when they cannot be written.
void MakeFloor(const FloorFiles& files, const FloorCase& floor_case);

/// Runs MakeFloor and builds the survey's map, unless the map exists. Throws the builder's exceptions.
void PrepareFloor(const FloorFiles& files, const FloorCase& floor_case, const ProgressOutput& progress);

/// Throws InputError when the file does not exist.
GrayFloor ReadGrayFloor(const FloorFiles& files, double wear);

/// A floor with its map.
struct BenchFloor {
  std::unique_ptr<MapDatabase> database;  ///< open because the localizer reads the mosaic from it
  std::unique_ptr<Localizer> localizer;
  Pose2 map_from_truth;          ///< fitted to the map's own frames
  double map_rms_m = 0.0;        ///< position error of the map's own frames after alignment
  std::vector<GrayFloor> looks;  ///< one per condition case
};

BenchFloor ReadBenchFloor(const FloorFiles& files, const std::vector<ConditionCase>& conditions);

}  // namespace floorloc
