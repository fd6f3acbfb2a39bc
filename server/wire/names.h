// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace floorloc {

/// [A-Za-z0-9_-]{1,64}: safe in a URL and as a file name.
bool IsMapName(std::string_view name);
/// [A-Za-z0-9_.-]{1,64}, but not "." and "..", which clients and proxies remove from paths.
bool IsVehicleId(std::string_view id);

}  // namespace floorloc
