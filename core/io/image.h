// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>

namespace floorloc {

enum class ImageFormat { kJpeg, kPng };

/// Header of an encoded image, read without decoding.
struct ImageHeader {
  ImageFormat format = ImageFormat::kJpeg;
  int width_px = 0;
  int height_px = 0;
  int bits = 8;  ///< per channel
};

/// Reads the header of a JPEG or PNG. Empty when the bytes are neither, or the header is cut off or damaged.
std::optional<ImageHeader> ProbeImage(std::span<const std::uint8_t> bytes);

/// Decodes a JPEG or PNG to 8-bit grey, ignoring EXIF orientation. The header must give exactly width_px x height_px,
/// which is checked before decoding. Of a PNG with 16 bits, the highest 8 that are used: sensors have 10, 12 or 14,
/// which drivers write as they are (Mono12) or shifted to the top; each image tells which by its values. Returns
/// CV_8UC1. `source` names the image in errors. Throws InputError.
cv::Mat DecodeGray(std::span<const std::uint8_t> bytes, int width_px, int height_px,
                   const std::filesystem::path& source);
/// The same, to 8-bit BGR (CV_8UC3).
cv::Mat DecodeColor(std::span<const std::uint8_t> bytes, int width_px, int height_px,
                    const std::filesystem::path& source);

/// Reads and decodes an image of the given size from a file. Throws InputError.
cv::Mat ReadGrayImage(const std::filesystem::path& file, int width_px, int height_px);
cv::Mat ReadColorImage(const std::filesystem::path& file, int width_px, int height_px);
/// Reads a colour image reduced to an eighth of its width and height, rounded up or down; several times faster than the
/// full size for a JPEG. Throws InputError.
cv::Mat ReadSmallColorImage(const std::filesystem::path& file, int width_px, int height_px);

}  // namespace floorloc
