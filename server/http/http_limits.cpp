// SPDX-License-Identifier: Apache-2.0
#include "server/http/http_limits.h"

#include "core/geometry/option_check.h"

namespace floorloc {

void HttpLimits::Check() const {
  RequireOption(max_body_bytes >= 1, "limits.max_body_bytes must be at least 1");
  RequireOption(max_bodies_bytes >= max_body_bytes, "limits.max_bodies_bytes must be at least limits.max_body_bytes");
  RequireOption(max_connections >= 1, "limits.max_connections must be at least 1");
  RequireOption(max_connections_per_address >= 1, "limits.max_connections_per_address must be at least 1");
  RequireOption(reserved_connections >= 0, "limits.reserved_connections must not be negative");
  RequireOption(reserved_timeout_s > 0.0, "reserved_timeout_s must be positive");
  RequireOption(idle_timeout_s > 0.0, "limits.idle_timeout_s must be positive");
  RequireOption(stop_timeout_s > 0.0, "stop_timeout_s must be positive");
  RequireOption(request_timeout_s > 0.0, "limits.request_timeout_s must be positive");
}

}  // namespace floorloc
