// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mapbuilder/report/quality.h"

namespace floorloc {

/// Groups weak cells into zones, adds dropped frames and failed held-out frames, and sorts by importance. Fills zones
/// and weak_m2, and clears the weakness of zones too small to report.
void CollectZones(const MapEvidence& evidence, const QualityOptions& options, MapQuality* quality);

}  // namespace floorloc
