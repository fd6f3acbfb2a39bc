// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

namespace floorloc {

/// Everything directly in a folder, by name. Throws InputError when it cannot be read as a folder.
std::vector<std::filesystem::path> SortedEntries(const std::filesystem::path& folder);

/// The files directly in a folder whose names are those of JPEG or PNG images, by name. Throws as SortedEntries().
std::vector<std::filesystem::path> ImageFilesIn(const std::filesystem::path& folder);

}  // namespace floorloc
