// SPDX-License-Identifier: Apache-2.0
#include "core/io/floor_picture.h"

#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <vector>

#include "core/io/encoded_image.h"
#include "core/io/image.h"
#include "core/io/input_error.h"
#include "core/io/text_file.h"

namespace floorloc {
namespace {

constexpr std::int64_t kMaxPixels = 100'000'000;

std::string SizeText(int width_px, int height_px) { return std::to_string(width_px) + "x" + std::to_string(height_px); }

// All that can be said of the file without decoding it.
void CheckHeader(const std::filesystem::path& file, const std::vector<std::uint8_t>& bytes,
                 const MeasuredImage& expected) {
  const std::optional<ImageHeader> header = ProbeImage(bytes);
  const std::string must = "; " + expected.what + " must be a grey PNG of 16 bits";
  if (!header || header->format != ImageFormat::kPng) {
    throw InputError(file, "is not a PNG image" + must);
  }
  if (header->width_px != expected.size.width || header->height_px != expected.size.height) {
    throw InputError(file, "is " + SizeText(header->width_px, header->height_px) + ", its picture is " +
                               SizeText(expected.size.width, expected.size.height) +
                               "; register it to the picture's pixels");
  }
  if (header->bits != 16 && !(expected.also_8_bits && header->bits == 8)) {
    throw InputError(file, "has " + std::to_string(header->bits) + " bits per value" + must);
  }
  if (!HasPngEnd(bytes)) {
    throw InputError(file, "the image is cut off or damaged; copy it again or remove it");
  }
}

}  // namespace

cv::Mat ReadPictureOfAnySize(const std::filesystem::path& file) {
  const std::vector<std::uint8_t> bytes = ReadBinaryFile(file);
  const ImageHeader header = ProbeImage(bytes).value_or(ImageHeader{});
  if (std::int64_t{header.width_px} * header.height_px > kMaxPixels) {
    throw InputError(file, "has more than 100 million pixels; make it smaller");
  }
  return DecodeColor(bytes, header.width_px, header.height_px, file);
}

cv::Mat ReadMeasuredImage(const std::filesystem::path& file, const MeasuredImage& expected) {
  const std::vector<std::uint8_t> bytes = ReadBinaryFile(file);
  CheckHeader(file, bytes, expected);
  cv::Mat image;
  try {
    image = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    // Stays empty.
  }
  if (image.size() != expected.size) {
    throw InputError(file, "the image is damaged; copy it again or remove it");
  }
  if (image.channels() != 1) {
    throw InputError(file, "has colours; " + expected.what + " must be a grey PNG of 16 bits");
  }
  if (image.depth() == CV_8U) {
    image.convertTo(image, CV_16U);
  }
  return image;
}

}  // namespace floorloc
