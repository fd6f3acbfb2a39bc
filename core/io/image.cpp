// SPDX-License-Identifier: Apache-2.0
#include "core/io/image.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <numeric>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "core/io/encoded_image.h"
#include "core/io/input_error.h"
#include "core/io/jpeg_decoder.h"
#include "core/io/text_file.h"

namespace floorloc {
namespace {

constexpr int kMaxSidePx = 16384;
constexpr int kMaxJpegScans = 100;

std::string SizeText(int width_px, int height_px) { return std::to_string(width_px) + "x" + std::to_string(height_px); }

// All checks that need no decoding, so that no header can cause large allocations or long decoding.
ImageHeader CheckBeforeDecoding(std::span<const std::uint8_t> bytes, const cv::Size& expected,
                                const std::filesystem::path& source) {
  const std::optional<ImageHeader> header = ProbeImage(bytes);
  if (!header) {
    throw InputError(source, "is not a JPEG or PNG image, or its header is damaged; use an intact JPEG or PNG");
  }
  if (header->width_px != expected.width || header->height_px != expected.height) {
    throw InputError(source, "the image is " + SizeText(header->width_px, header->height_px) +
                                 " but camera.yaml says " + SizeText(expected.width, expected.height) +
                                 "; use images of the calibrated camera");
  }
  if (std::max(expected.width, expected.height) > kMaxSidePx) {
    throw InputError(source, "the image is larger than 16384 pixels a side; use a smaller one");
  }
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    throw InputError(source, "the file is larger than 2 GiB; use a smaller image");
  }
  const bool is_jpeg = header->format == ImageFormat::kJpeg;
  if (is_jpeg && header->bits != 8) {
    throw InputError(source, "is a JPEG of " + std::to_string(header->bits) +
                                 " bits per channel, which cannot be read; save it as a PNG, or with 8 bits");
  }
  const std::optional<int> scans = is_jpeg ? CountJpegScans(bytes) : std::nullopt;
  if (is_jpeg ? !scans : !HasPngEnd(bytes)) {
    throw InputError(source, "the image is cut off or damaged; copy it again or remove it");
  }
  if (is_jpeg && *scans > kMaxJpegScans) {
    throw InputError(source, "the JPEG has more than 100 scans; save it again as an ordinary JPEG");
  }
  return *header;
}

// The number of bits that the values of a 16-bit image have: 16, or that of the sensor when it was not shifted to the
// top.
int SignificantBits(const cv::Mat& image) {
  constexpr int kBitsOfSensors[] = {8, 10, 12, 14};
  unsigned used = 0;
  for (int row = 0; row < image.rows; ++row) {
    const auto* values = image.ptr<std::uint16_t>(row);
    used = std::accumulate(values, values + image.cols * image.channels(), used, std::bit_or<>());
  }
  const bool is_shifted_to_the_top = used % 4 == 0;  // at least the 14 bits of the finest sensors
  for (const int bits : kBitsOfSensors) {
    if (!is_shifted_to_the_top && used >> bits == 0) {
      return bits;
    }
  }
  return 16;
}

cv::Mat To8Bits(const cv::Mat& image) {
  cv::Mat highest;
  // Minus a half: cut off like the decoders do, not rounded.
  const double scale = std::exp2(8 - SignificantBits(image));
  image.convertTo(highest, CV_8U, scale, scale < 1.0 ? 0.5 * (scale - 1.0) : 0.0);
  return highest;
}

// imdecode only reads the buffer, but cv::Mat has no const header.
cv::Mat DecodePng(std::span<const std::uint8_t> bytes, int flags) {
  const cv::Mat buffer(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<std::uint8_t*>(bytes.data()));
  try {
    return cv::imdecode(buffer, flags | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
    return {};
  }
}

// shrink: reduction factor of the flags.
cv::Mat Decode(std::span<const std::uint8_t> bytes, int flags, const cv::Size& expected,
               const std::filesystem::path& source, int shrink = 1) {
  const ImageHeader header = CheckBeforeDecoding(bytes, expected, source);
  flags |= header.bits == 16 ? cv::IMREAD_ANYDEPTH : 0;
  const bool color = (flags & cv::IMREAD_COLOR) != 0;
  const cv::Mat decoded =
      header.format == ImageFormat::kJpeg ? DecodeJpeg(bytes, {color, shrink}) : DecodePng(bytes, flags);
  // Some decoders round reduced sizes up, others down.
  if (std::abs(decoded.cols * shrink - expected.width) >= shrink ||
      std::abs(decoded.rows * shrink - expected.height) >= shrink) {
    throw InputError(source, "the image is damaged; copy it again or remove it");
  }
  return decoded.depth() == CV_16U ? To8Bits(decoded) : decoded;
}

}  // namespace

cv::Mat DecodeGray(std::span<const std::uint8_t> bytes, int width_px, int height_px,
                   const std::filesystem::path& source) {
  return Decode(bytes, cv::IMREAD_GRAYSCALE, {width_px, height_px}, source);
}

cv::Mat DecodeColor(std::span<const std::uint8_t> bytes, int width_px, int height_px,
                    const std::filesystem::path& source) {
  return Decode(bytes, cv::IMREAD_COLOR, {width_px, height_px}, source);
}

cv::Mat ReadGrayImage(const std::filesystem::path& file, int width_px, int height_px) {
  return DecodeGray(ReadBinaryFile(file), width_px, height_px, file);
}

cv::Mat ReadColorImage(const std::filesystem::path& file, int width_px, int height_px) {
  return DecodeColor(ReadBinaryFile(file), width_px, height_px, file);
}

cv::Mat ReadSmallColorImage(const std::filesystem::path& file, int width_px, int height_px) {
  constexpr int kShrink = 8;
  return Decode(ReadBinaryFile(file), cv::IMREAD_REDUCED_COLOR_8, {width_px, height_px}, file, kShrink);
}

}  // namespace floorloc
