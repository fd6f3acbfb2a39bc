// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "mapbuilder/bag/bag_reader.h"

namespace floorloc {

/// Whether a path is a bag, by what is in it: a file of one of the kinds, or a folder with metadata.yaml or such files.
bool IsBag(const std::filesystem::path& path);

/// The files of a bag in their order: of a folder those that metadata.yaml lists, or all of them by the numbers in
/// their names. Throws InputError that says what is missing.
std::vector<std::filesystem::path> BagFiles(const std::filesystem::path& path);

/// Opens rosbag2 (SQLite or MCAP, a file or a folder of them), MCAP and rosbag1, by what is in the files. Throws
/// InputError.
std::unique_ptr<BagReader> OpenBag(const std::filesystem::path& path);

}  // namespace floorloc
