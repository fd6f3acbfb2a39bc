// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/build/build_report.h"
#include "mapbuilder/build/held_out.h"
#include "mapbuilder/mosaic/exposure.h"

namespace floorloc {

/// Adds the frames without a pose, and says of all dropped frames about where they were taken, as far as their survey's
/// odometry tells. reason: per frame.
void AddDropped(const PlacedSurvey& placed, const std::vector<std::string>& reason, std::vector<DroppedFrame>* dropped);

/// Every control point of every survey whose frame is in the map.
std::vector<ControlPointError> CompareControlPoints(const PlacedSurvey& placed);

/// The exposure's flat fields, coarsely, 1 in the middle.
std::vector<FlatField> SampleFlatFields(const Exposure& exposure);

}  // namespace floorloc
