// SPDX-License-Identifier: Apache-2.0
#include "core/io/camera_mask.h"

#include <opencv2/core.hpp>

#include "core/io/image.h"
#include "core/io/input_error.h"
#include "core/io/text_file.h"

namespace floorloc {

cv::Mat DecodeCameraMask(std::span<const std::uint8_t> bytes, const CameraModel& camera,
                         const std::filesystem::path& source) {
  cv::Mat mask = DecodeGray(bytes, camera.width_px, camera.height_px, source) > 0;
  if (cv::countNonZero(mask) == 0) {
    throw InputError(source, "masks everything; paint white what is floor");
  }
  return mask;
}

cv::Mat ReadCameraMask(const std::filesystem::path& folder, const CameraModel& camera) {
  const std::filesystem::path file = folder / "mask.png";
  return std::filesystem::exists(file) ? DecodeCameraMask(ReadBinaryFile(file), camera, file) : cv::Mat();
}

double MaskedShare(const cv::Mat& mask) {
  return mask.empty() ? 0.0 : 1.0 - static_cast<double>(cv::countNonZero(mask)) / static_cast<double>(mask.total());
}

}  // namespace floorloc
