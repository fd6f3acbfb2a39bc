// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "core/map/floor_map.h"
#include "server/serving/camera_mask.h"
#include "server/serving/rectifier_store.h"

namespace floorloc {

/// A camera as a client gives it.
struct GivenCamera {
  FloorCamera camera;
  CameraMask mask;      ///< empty: the map's of this camera, if it has one
  bool correct = true;  ///< by a map that knows the camera
};

/// How a map changed a camera that it knows.
struct AppliedCorrection {
  int survey = 0;         ///< index into MapInfo::cameras
  double moved_px = 0.0;  ///< largest displacement of a floor point, pixels of the rectified image
};

/// A camera as it is used with a map.
struct MapCamera {
  std::shared_ptr<const Rectifier> rectifier;   ///< of the corrected camera, at the map's resolution
  std::optional<AppliedCorrection> correction;  ///< empty: the camera is used as given
};

/// How a map corrects a camera; empty when it does not know it, or the client declined. Takes microseconds.
std::optional<AppliedCorrection> CorrectionOf(const MapInfo& info, const GivenCamera& given);

/// The form of a camera that a map is asked with. Throws Problem as RectifierStore::Get does.
MapCamera CameraInMap(const MapInfo& info, const GivenCamera& given, RectifierStore& store);

}  // namespace floorloc
