// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace floorloc {

/// Parses the segments of a JPEG without decoding the compressed data. Returns the number of scans, or empty when the
/// file ends before its end marker: decoders only warn about that and fill in the missing rows.
std::optional<int> CountJpegScans(std::span<const std::uint8_t> bytes);

/// Parses the chunks of a PNG. False when the file ends before its end chunk.
bool HasPngEnd(std::span<const std::uint8_t> bytes);

}  // namespace floorloc
