// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/api/app.h"

namespace floorloc {

/// Registers the vehicles that were registered when the server ended, each with the pose that it had then. One whose
/// registration is not accepted any more is logged and left out.
void RestoreVehicles(AppState& state);

}  // namespace floorloc
