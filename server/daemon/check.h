// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "server/daemon/daemon.h"

namespace floorloc {

/// Tries everything that a start with these options needs, and goes on after what fails: the configuration, the tokens,
/// the address, the number of open files, and every byte of every map. Prints a line for each: "ok", "note" (works, and
/// is worth knowing) or "FAILED". Returns the exit code: 0, 1 when something failed, 2 when the options and the
/// configuration contradict each other. Throws std::invalid_argument for an address that is none, InputError for a maps
/// folder that cannot be read.
int CheckDeployment(const DaemonOptions& options, std::ostream& out);

}  // namespace floorloc
