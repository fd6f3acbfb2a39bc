// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "core/io/input_error.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc::testing_io {

using floorloc::TemporaryFolder;

/// The message of the InputError that `work` throws; fails the test when it throws nothing or another exception.
inline std::string ErrorOf(const std::function<void()>& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "not an InputError: " << error.what();
    return {};
  }
  ADD_FAILURE() << "the input was accepted";
  return {};
}

/// A grey ramp with texture, encoded by OpenCV.
inline std::vector<std::uint8_t> EncodedImage(const std::string& extension, int width_px, int height_px) {
  cv::Mat image(height_px, width_px, CV_8UC3);
  for (int v = 0; v < height_px; ++v) {
    for (int u = 0; u < width_px; ++u) {
      image.at<cv::Vec3b>(v, u) = {static_cast<std::uint8_t>(u % 256), static_cast<std::uint8_t>(v % 256),
                                   static_cast<std::uint8_t>(u * 7 % 256)};
    }
  }
  std::vector<std::uint8_t> bytes;
  cv::imencode(extension, image, bytes);
  return bytes;
}

inline const char kCameraYaml[] =
    "image_width: 640\n"
    "image_height: 480\n"
    "camera_name: front\n"
    "camera_matrix:\n"
    "  rows: 3\n"
    "  cols: 3\n"
    "  data: [598.3, 0.0, 322.4, 0.0, 597.6, 238.7, 0.0, 0.0, 1.0]\n"
    "distortion_model: plumb_bob\n"
    "distortion_coefficients:\n"
    "  rows: 1\n"
    "  cols: 5\n"
    "  data: [-0.25, 0.06, 0.0008, -0.0005, 0.0]\n";

inline const char kFloorYaml[] =
    "homography: [0.0, -0.00067, 0.36, -0.00067, 0.0, 0.2155, 0.0, 0.0, 1.0]\n"
    "roi: {x_min: 0.045, x_max: 0.355, y_min: -0.205, y_max: 0.21}\n"
    "resolution: 0.0007\n";

/// `text` with the first occurrence of `from` replaced by `to`.
inline std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

}  // namespace floorloc::testing_io
