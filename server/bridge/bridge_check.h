// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "server/bridge/bridge_config.h"

namespace floorloc {

/// Tries what a start needs (secrets, the server and its vehicles, the broker) and prints a line for each. Returns the
/// exit code: 0 when the bridge can start, 1 when something would fail.
int CheckBridge(const BridgeConfig& config, std::ostream& out);

}  // namespace floorloc
