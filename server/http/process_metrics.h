// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

namespace floorloc {

/// What the kernel says of this process (proc(5)), under the names that Prometheus' own clients give it.
struct ProcessMetrics {
  double cpu_s = 0.0;    ///< user and system
  double start_s = 0.0;  ///< Unix time
  double resident_bytes = 0.0;
  double virtual_bytes = 0.0;
  double threads = 0.0;
  double open_files = 0.0;
  double max_open_files = 0.0;
};

/// Empty where /proc cannot be read.
std::optional<ProcessMetrics> ReadProcessMetrics();

}  // namespace floorloc
