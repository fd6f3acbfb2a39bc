// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/api/app.h"
#include "server/serving/fix_history.h"
#include "server/serving/localize_service.h"
#include "server/wire/problem.h"

// Shared by the calls that bring an image.
namespace floorloc {

/// Vehicle and time of an image.
struct FrameLabel {
  std::string vehicle;  ///< empty: the camera came inline
  double received_s = 0.0;
  double stamp_s = 0.0;
};

double UnixTimeNow();

/// A part of multipart/form-data. Throws Problem 400 invalid_parts when it is not there exactly once.
const HttpPart& RequirePart(const HttpRequest& request, const std::string& name);

Problem UnknownVehicle();
/// Throws UnknownVehicle().
VehicleState RequireVehicle(const AppState& state, const std::string& id);

/// Keeps a localization for viewers and counts it.
FixRecord RecordFix(AppState& state, const LoadedMap& map, const FrameLabel& label, const LocalizeOutcome& outcome);

}  // namespace floorloc
