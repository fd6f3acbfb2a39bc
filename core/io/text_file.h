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

/// Throws InputError when `file` cannot be created or replaced; to be called before a long computation that writes it.
void CheckWritable(const std::filesystem::path& file);

/// Writes to a temporary file beside `file`, flushes it to the disk and renames it, so that a crash or a full disk
/// leaves either the old or the new file. Throws InputError.
void WriteFileAtomically(const std::filesystem::path& file, const std::string& content);

}  // namespace floorloc
