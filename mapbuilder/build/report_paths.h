// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "mapbuilder/build/build_report.h"

namespace floorloc {

/// The report without the builder's directories, as stored in a map: the same files in another directory give the same
/// map, and a published map reveals no paths. surveys: their folders, whose names are kept. file: a further file that
/// warnings may name; may be empty.
BuildReport WithoutFolders(BuildReport report, const std::vector<std::filesystem::path>& surveys,
                           const std::filesystem::path& file);

}  // namespace floorloc
