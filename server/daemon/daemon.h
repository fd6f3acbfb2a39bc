// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace floorloc {

/// The command line of floorloc-server.
struct DaemonOptions {
  std::filesystem::path maps_folder;
  std::string listen = "127.0.0.1:8080";
  std::filesystem::path config_file;  ///< empty: all defaults
  bool check = false;                 ///< try everything that a start needs, print it, and exit
};

/// Serves until SIGTERM or SIGINT, then finishes the requests in flight. Returns the exit code: 0, with `check` that of
/// CheckDeployment. Throws with one sentence when it cannot start.
int RunDaemon(const DaemonOptions& options);

}  // namespace floorloc
