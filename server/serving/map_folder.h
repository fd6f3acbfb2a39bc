// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace floorloc {

/// Every *.floormap file of a folder, sorted. Throws InputError when it can't be read.
std::vector<std::filesystem::path> ListMapFiles(const std::filesystem::path& folder);

/// The content version that a file claims, unverified; empty when it claims none.
std::string PeekMapVersion(const std::filesystem::path& file);

}  // namespace floorloc
