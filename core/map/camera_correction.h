// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "core/map/floor_map.h"

namespace floorloc {

/// A camera as the images of a survey corrected it.
struct CameraCorrection {
  int survey = 0;         ///< index into MapInfo::cameras
  FloorCamera camera;     ///< with the region of interest and the resolution of the camera that was asked about
  double moved_px = 0.0;  ///< by how much floor points moved at most, pixels of the rectified image
};

/// The map's form of a camera that has the calibration of one of its surveys (camera.yaml and floor.yaml are equal but
/// for the name, the region of interest and the resolution); of the newest such survey. Empty for other cameras.
std::optional<CameraCorrection> CorrectCamera(const MapInfo& info, const FloorCamera& camera);

/// The same, or the camera itself.
FloorCamera CorrectedOrGiven(const MapInfo& info, const FloorCamera& camera);

/// True for the same lens, size and homography; name, region of interest and resolution may differ.
bool SameCalibration(const FloorCamera& a, const FloorCamera& b);

/// Largest displacement of the floor points of the region of interest (corners, edges, centre) between two calibrations
/// of a camera, metres.
double LargestDisplacement(const FloorCamera& before, const FloorCamera& after);

}  // namespace floorloc
