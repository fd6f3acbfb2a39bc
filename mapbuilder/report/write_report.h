// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "mapbuilder/report/verdict.h"

namespace floorloc {

/// Makes the folder, if need be, and throws InputError when a report can't be written there: to be asked before long
/// work.
void PrepareReportFolder(const std::filesystem::path& folder);

/// Writes folder/report.html and folder/report.json about a map. Throws MapError or InputError.
Verdict WriteReport(const std::filesystem::path& map_file, const std::filesystem::path& folder);

}  // namespace floorloc
