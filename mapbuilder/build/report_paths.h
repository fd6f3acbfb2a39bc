// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "mapbuilder/build/build_report.h"

namespace floorloc {

/// The report without where its files lay on the builder's disk, as a map carries it: the same files elsewhere give the
/// same map, and whoever gets the map learns no folders. surveys: their folders, which keep their names. file: another
/// one that its sentences may name; may be empty.
BuildReport WithoutFolders(BuildReport report, const std::vector<std::filesystem::path>& surveys,
                           const std::filesystem::path& file);

}  // namespace floorloc
