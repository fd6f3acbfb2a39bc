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

/// Adds the results of screening. odometry: warnings about it.
void AddScreening(const ScreenedFrames& screened, const std::vector<std::string>& odometry, BuildReport* report);

/// Adds what is known once all frames are placed: frames, links, drift, control points, markers, calibration.
void AddPlacement(const PlacedSurveys& placed, const CalibratedFrames& calibrated, BuildReport* report);

/// Adds what is known of the map's scale, and names distances that contradict it. Coverage is added before.
/// base_report: of the map that was extended; empty: none.
void AddScale(const CalibratedFrames& calibrated, const BuildOptions& options, const std::string& base_report,
              BuildReport* report);

void AddCoverage(const CoverageGrid& coverage, BuildReport* report);

/// Appends the frames without a pose, and estimates for every dropped frame where it was taken if its survey has
/// odometry. reason: one per frame.
void AddDropped(const PlacedSurvey& placed, const std::vector<std::string>& reason, std::vector<DroppedFrame>* dropped);

/// Error of every control point of every survey whose frame is in the map.
std::vector<ControlPointError> CompareControlPoints(const PlacedSurvey& placed);

/// Flat fields of the exposure, coarsely sampled; the gain at the image centre is 1.
std::vector<FlatField> SampleFlatFields(const Exposure& exposure);

}  // namespace floorloc
