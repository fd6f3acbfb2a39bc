// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "mapbuilder/bag/ros_messages.h"

namespace floorloc {

/// An image as a file: its bytes, and the ending of its name.
struct ImageFile {
  std::string extension;  ///< ".jpg" or ".png"
  std::vector<std::uint8_t> bytes;
};

/// The image of a raw message: CV_8UC1, CV_16UC1, CV_8UC3 or CV_16UC3 (BGR). Encodings of
/// sensor_msgs/image_encodings.h: mono8, mono16, rgb8, bgr8, rgba8, bgra8 (without their alpha), rgb16, bgr16, bayer_*
/// (demosaiced), yuv422, yuv422_yuy2 and their other names, 8UC1, 8UC3, 16UC1. Throws InputError that names `topic`.
cv::Mat DecodeRaw(const RosImage& image, const std::string& topic);

/// The bytes of a compressed image as they are: JPEG or PNG, whatever its format field says; of a raw one a PNG without
/// loss. Throws InputError that names the topic.
ImageFile ToImageFile(const BagMessage& message);

}  // namespace floorloc
