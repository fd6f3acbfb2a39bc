// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/unpack/bag_summary.h"
#include "mapbuilder/unpack/survey_plan.h"

namespace floorloc {

struct UnpackedBag {
  std::int64_t frames = 0;
  std::int64_t odometry = 0;          ///< rows of odometry.tum
  std::int64_t imu = 0;               ///< rows of imu.csv
  std::vector<std::string> notes;     ///< of the plan
  std::vector<std::string> warnings;  ///< what was cut, left out or put in order; one sentence each
};

/// Name of a bag without the endings of its kind.
std::string BagName(const std::filesystem::path& bag);

/// Writes a bag as a survey folder (docs/survey.md): camera.yaml, floor.yaml, frames.csv and images/ (compressed images
/// byte by byte, raw ones as PNG), odometry.tum, imu.csv and groundtruth.tum where the plan has them. Rows are in the
/// order of the headers' stamps. The folder appears only when it is complete. Memory holds one message, and the rows of
/// the tables. Throws InputError: what the plan misses, a damaged bag, a folder that exists or cannot be written.
UnpackedBag UnpackBag(const BagSummary& bag, const SurveyPlan& plan, const std::filesystem::path& folder,
                      const RunOptions& run);

}  // namespace floorloc
