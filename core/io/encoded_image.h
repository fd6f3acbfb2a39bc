// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace floorloc {

/// Walks over a JPEG's segments and its compressed data without decoding them. Returns the number of scans, or empty
/// when the file ends before its end marker: decoders only warn about that and make up the missing rows.
std::optional<int> CountJpegScans(std::span<const std::uint8_t> bytes);

/// Walks over a PNG's chunks. False when the file ends before its end chunk.
bool HasPngEnd(std::span<const std::uint8_t> bytes);

}  // namespace floorloc
