// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "server/api/app.h"
#include "server/serving/fix_history.h"
#include "server/serving/localize_service.h"
#include "server/wire/problem.h"

// Shared by the calls that take an image.
namespace floorloc {

/// Vehicle and time of an image.
struct FrameLabel {
  std::string vehicle;  ///< empty: the request contained the camera
  double received_s = 0.0;
  double stamp_s = 0.0;
  WorkClass work = WorkClass::kSearch;  ///< class of the queue that it waited in
  std::optional<FixOutcome> outcome;    ///< see FixRecord
};

/// A part of multipart/form-data; null when it is not there. Throws Problem 400 invalid_parts when it is there twice.
const HttpPart* FindPart(const HttpRequest& request, const std::string& name);
/// The same for one that must be there. Throws Problem 400 invalid_parts.
const HttpPart& RequirePart(const HttpRequest& request, const std::string& name);

Problem UnknownVehicle();
/// Throws UnknownVehicle().
VehicleState RequireVehicle(const AppState& state, const std::string& id);

/// The camera of a vehicle as a map wants it: what its registration prepared, unless that was for another map or
/// version. Throws Problem as RectifierStore::Get does. To be called in the compute pool: it may have to build tables.
MapCamera VehicleCameraIn(const LoadedMap& map, const Vehicle& vehicle, RectifierStore& store);

/// Adds a localization to the fix history and the metrics, and keeps the image as the vehicle's last one.
FixRecord RecordFix(AppState& state, const LocalizeJob& job, const FrameLabel& label, const LocalizeOutcome& outcome);

}  // namespace floorloc
