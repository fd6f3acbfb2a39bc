// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace floorloc {

/// Radius of the circle about the estimate that holds the true position with 95 %, metres, for a normal distribution
/// with this covariance of (x, y, yaw), row by row. Between 1.96 of the larger standard deviation, where the other one
/// is zero, and 2.45 of it, where both are equal.
double DeviationRange(const std::array<double, 9>& covariance);

}  // namespace floorloc
