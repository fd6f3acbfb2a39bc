// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "mapbuilder/self_calibration/self_calibration.h"

namespace floorloc {

/// One line per survey with the correction of its camera's calibration. Empty without self-calibration.
std::string ToText(const SelfCalibration& calibration);

/// {"tracks", "rms_before_m", "rms_after_m", "given_up", "cameras": [{unknown: {"change", "sigma"}, "unobserved":
/// [..]}]}; null without self-calibration.
std::string ToJson(const SelfCalibration& calibration);

}  // namespace floorloc
