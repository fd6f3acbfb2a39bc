// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/geometry/option_check.h"
#include "mapbuilder/batch/progress.h"

namespace floorloc {

/// How a stage runs, as opposed to what it computes: results are the same for all values. Hence no seed here; the
/// stages that draw random numbers have their own.
struct RunOptions {
  int threads = 0;               ///< 0: one per core; stages without parallel work have one thread
  ProgressOutput progress = {};  ///< stages that take no time worth reporting are silent

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const { RequireOption(threads >= 0, "threads must be 0 (one per core) or more"); }
};

}  // namespace floorloc
