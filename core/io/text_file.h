// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace floorloc {

/// Reads a whole file. Throws InputError when it is missing, unreadable or larger than `max_bytes`.
std::string ReadTextFile(const std::filesystem::path& file, std::uint64_t max_bytes = 256u << 20);
std::vector<std::uint8_t> ReadBinaryFile(const std::filesystem::path& file, std::uint64_t max_bytes = 256u << 20);

/// Throws InputError when `file` could not be created or replaced: to be asked before long work whose result goes
/// there.
void CheckWritable(const std::filesystem::path& file);

/// Writes to a temporary file beside `file`, flushes it to the disk and renames it: a crash or a full disk leaves
/// either the old file or the new one. Throws InputError.
void WriteFileAtomically(const std::filesystem::path& file, const std::string& content);

}  // namespace floorloc
