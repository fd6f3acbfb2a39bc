// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "mapbuilder/bag/bag_reader.h"

namespace floorloc {

/// Reads one file of rosbag2's SQLite storage, of any of its schemas; messages may be compressed with zstd one by one.
/// A file that is compressed as a whole (.db3.zstd) is decompressed to a temporary one. Throws InputError.
std::unique_ptr<BagReader> ReadRosbag2(const std::filesystem::path& file);

}  // namespace floorloc
