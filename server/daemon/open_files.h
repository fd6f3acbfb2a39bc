// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "server/http/http_limits.h"

namespace floorloc {

struct OpenFiles {
  std::uint64_t wanted = 0;   ///< for all connections and what the server itself opens
  std::uint64_t allowed = 0;  ///< to this process, from now on
};

/// Each connection is an open file, and many systems allow 1,024 unless asked for more: asks for as many as needed.
OpenFiles AllowOpenFiles(const HttpLimits& limits);

}  // namespace floorloc
