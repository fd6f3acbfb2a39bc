// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <ostream>

#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/surface/boosting.h"

namespace floorloc {

struct PictureTrialOptions {
  std::filesystem::path folder;  ///< a folder of pictures per class
  BoostingOptions boosting;
  RunOptions run;
};

/// Cross-validates whole pictures by the paper's groups that need no range, with shape, and with texture: with folds
/// that keep pictures apart that look alike, and with random folds. Prints tables.
void TryPictures(const PictureTrialOptions& options, std::ostream& out);

}  // namespace floorloc
