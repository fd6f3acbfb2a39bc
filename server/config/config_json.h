// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/config/config.h"

namespace floorloc {

/// Strict: a key that is not known, or a value that makes no sense, throws JsonError that names it.
ServerConfig ParseServerConfig(const std::string& text);

}  // namespace floorloc
