// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/config/config.h"

namespace floorloc {

/// An unknown key or an invalid value throws JsonError that names it.
ServerConfig ParseServerConfig(const std::string& text);

}  // namespace floorloc
