// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/build/build_report.h"
#include "mapbuilder/build/held_out.h"
#include "mapbuilder/build/place_surveys.h"
#include "mapbuilder/coverage/coverage.h"
#include "mapbuilder/mosaic/exposure.h"
#include "mapbuilder/screening/frame_screening.h"
#include "mapbuilder/self_calibration/self_calibration.h"

namespace floorloc {

/// Adds what the screening found. odometry: warnings of CheckOdometry.
void AddScreening(const ScreenedFrames& screened, const std::vector<std::string>& odometry, BuildReport* report);

/// Adds what is known once all frames have their places: frames, links, drift, control points, markers, calibration.
void AddPlacement(const PlacedSurveys& placed, const CalibratedFrames& calibrated, BuildReport* report);

void AddCoverage(const CoverageGrid& coverage, BuildReport* report);

/// Adds the frames without a pose, and says of all dropped frames about where they were taken, by their survey's
/// odometry, where it has any. reason: per frame.
void AddDropped(const PlacedSurvey& placed, const std::vector<std::string>& reason, std::vector<DroppedFrame>* dropped);

/// Every control point of every survey whose frame is in the map.
std::vector<ControlPointError> CompareControlPoints(const PlacedSurvey& placed);

/// The exposure's flat fields, coarsely, 1 in the middle.
std::vector<FlatField> SampleFlatFields(const Exposure& exposure);

}  // namespace floorloc
