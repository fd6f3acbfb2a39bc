// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

namespace floorloc {

/// Image manipulations as in common augmentation libraries.
enum class Condition {
  kShadow,      ///< one or two random pentagons in the lower half have half the brightness
  kFog,         ///< patchy white veil of random density, and blur of up to a 30th of the width
  kBrightness,  ///< adds a random value from -51 to 51 to all grey levels, clamped to 0 to 255
  kRotation,    ///< by 180 degrees
};

constexpr std::array<Condition, 4> kConditions = {Condition::kShadow, Condition::kFog, Condition::kBrightness,
                                                  Condition::kRotation};

/// "shadow", "fog", "brightness", "rotation"
const char* ToString(Condition condition);

/// Manipulated copy, deterministic for a given seed. gray: CV_8UC1, not empty.
cv::Mat Manipulate(const cv::Mat& gray, Condition condition, std::uint32_t seed);

/// Position in the copy of a point of the image, px.
cv::Point2f PointInCopy(const cv::Point2f& position, Condition condition, const cv::Size& size);

}  // namespace floorloc
