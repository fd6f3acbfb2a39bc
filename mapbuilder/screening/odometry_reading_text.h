// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "mapbuilder/screening/odometry_reading.h"

namespace floorloc {

/// What would make odometry fit, as "x and y of its positions are exchanged"; empty: it does as it is.
std::string FitsWhen(const MotionAgreement& agreement);

}  // namespace floorloc
