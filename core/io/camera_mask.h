// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <span>

#include "core/geometry/camera.h"

namespace floorloc {

/// Decodes a JPEG or PNG of the camera's size that is black where the camera's images show no floor (the robot's body).
/// CV_8UC1, 0 there and 255 elsewhere. `source` names the mask in errors. Throws InputError when it is no such image,
/// or all black.
cv::Mat DecodeCameraMask(std::span<const std::uint8_t> bytes, const CameraModel& camera,
                         const std::filesystem::path& source);

/// mask.png of a folder with camera.yaml; empty when there is none. Throws InputError.
cv::Mat ReadCameraMask(const std::filesystem::path& folder, const CameraModel& camera);

/// Share of the image that is masked, 0..1; 0 for an empty mask.
double MaskedShare(const cv::Mat& mask);

}  // namespace floorloc
