// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/open_files.h"

#include <sys/resource.h>

#include <algorithm>

namespace floorloc {

OpenFiles AllowOpenFiles(const HttpLimits& limits) {
  constexpr int kOwnFiles = 256;  // maps, log, listener
  const int files = limits.max_connections + limits.reserved_connections + kOwnFiles;
  const auto wanted = static_cast<rlim_t>(files);
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur < wanted) {
    const rlimit raised{std::min(wanted, limit.rlim_max), limit.rlim_max};
    limit = ::setrlimit(RLIMIT_NOFILE, &raised) == 0 ? raised : limit;
  }
  return {wanted, limit.rlim_cur};
}

}  // namespace floorloc
