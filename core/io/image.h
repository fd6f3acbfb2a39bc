// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>

namespace floorloc {

enum class ImageFormat { kJpeg, kPng };

/// What the header of an encoded image says; nothing has been decoded yet.
struct ImageHeader {
  ImageFormat format = ImageFormat::kJpeg;
  int width_px = 0;
  int height_px = 0;
};

/// Reads the header of a JPEG or PNG. Empty when the bytes are neither, or the header is cut off or damaged.
std::optional<ImageHeader> ProbeImage(std::span<const std::uint8_t> bytes);

/// Decodes a JPEG or PNG to 8-bit grey, ignoring EXIF orientation. The header must announce exactly
/// width_px x height_px, which is checked before any pixel is decoded. `source` names the image in errors.
/// Throws InputError.
cv::Mat DecodeGray(std::span<const std::uint8_t> bytes, int width_px, int height_px,
                   const std::filesystem::path& source);
/// The same, to 8-bit BGR.
cv::Mat DecodeColor(std::span<const std::uint8_t> bytes, int width_px, int height_px,
                    const std::filesystem::path& source);

/// Reads and decodes an image of the given size from a file. Throws InputError.
cv::Mat ReadGrayImage(const std::filesystem::path& file, int width_px, int height_px);
cv::Mat ReadColorImage(const std::filesystem::path& file, int width_px, int height_px);
/// An eighth as wide and high, rounded up or down; from a JPEG several times faster than the whole image.
cv::Mat ReadSmallColorImage(const std::filesystem::path& file, int width_px, int height_px);

}  // namespace floorloc
