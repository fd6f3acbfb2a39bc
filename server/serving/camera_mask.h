// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "core/geometry/camera.h"

namespace floorloc {

/// Where a camera's images show no floor but the robot's body, as a client sends it. It is decoded only for a camera
/// that is new to the server.
struct CameraMask {
  std::string digest;   ///< SHA-256 of what was sent; empty: no mask
  std::string encoded;  ///< PNG or JPEG; empty when `raw` holds it
  cv::Mat raw;          ///< CV_8UC1 of the camera's size, 0 where there is no floor

  bool empty() const { return digest.empty(); }
};

/// Throws Problem 413 mask_too_large.
CameraMask MakeCameraMask(std::string encoded);
/// From the base64 of a JSON field. Throws JsonError when it is none, Problem 413 mask_too_large.
CameraMask ParseCameraMask(const std::string& base64);

/// By its header only, before it is queued. Throws Problem 422: invalid_mask, mask_size_mismatch.
void CheckMaskHeader(const CameraMask& mask, const CameraModel& camera);
/// Throws Problem 422: those of CheckMaskHeader.
cv::Mat DecodeMask(const CameraMask& mask, const CameraModel& camera);

}  // namespace floorloc
