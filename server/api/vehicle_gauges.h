// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "server/api/app.h"
#include "server/http/metrics.h"

namespace floorloc {

/// How many vehicles have each status, how many each health of their odometry, and for how long each was silent.
std::vector<Gauge> VehicleGauges(const AppState& state);

}  // namespace floorloc
