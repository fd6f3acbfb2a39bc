// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "core/diagnosis/finding.h"
#include "core/geometry/readout.h"
#include "core/localization/readout_fit.h"

namespace floorloc {

/// Whether the camera's rows are exposed one after the other, and what to write into camera.yaml. Empty where
/// camera.yaml tells it, or the drive does not show it (too slow, or no odometry).
std::vector<Finding> FindingsOfReadout(const Readout& given, const std::optional<ReadoutMeasurement>& learnt);

}  // namespace floorloc
