// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "mapbuilder/report/verdict.h"

namespace floorloc {

/// Creates the folder if necessary and throws InputError when it is not writable; to be called before long work.
void PrepareReportFolder(const std::filesystem::path& folder);

/// Verdict on a map, without a report. Throws MapError.
Verdict AssessMapFile(const std::filesystem::path& map_file);

/// Writes folder/report.html and folder/report.json for a map. Throws MapError or InputError.
Verdict WriteReport(const std::filesystem::path& map_file, const std::filesystem::path& folder);

}  // namespace floorloc
