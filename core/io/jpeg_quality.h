// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace floorloc {

/// Estimates the quality, 1 to 100 on libjpeg's scale, that a JPEG was compressed with, from the quantisation table of
/// its first component: its ten lowest frequencies, which floors are recognized by, beside those of ITU T.81 table K.1,
/// scaled as by jpeg_quality_scaling(). Cameras with tables of their own get the quality that loses as much. Parses
/// headers only. Empty: no JPEG, or a damaged one.
std::optional<int> EstimateJpegQuality(std::span<const std::uint8_t> bytes);

/// What is wrong with images of a low quality, and what to do, as one sentence without a full stop.
std::string CompressedTooMuch(int jpeg_quality);

}  // namespace floorloc
