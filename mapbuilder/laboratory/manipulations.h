// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

namespace floorloc {

/// What may happen to an image, in the manner of the usual tools for augmenting data.
enum class Condition {
  kShadow,      ///< one or two random pentagons in the lower half are half as bright
  kFog,         ///< a patchy white veil of random density, and blurred by up to a 30th of the width
  kBrightness,  ///< a random -51 to 51 is added to all grey levels, which stay in 0 to 255
  kRotation,    ///< turned by 180 degrees
};

constexpr std::array<Condition, 4> kConditions = {Condition::kShadow, Condition::kFog, Condition::kBrightness,
                                                  Condition::kRotation};

/// "shadow", "fog", "brightness", "rotation"
const char* ToString(Condition condition);

/// A manipulated copy; the same seed does the same. gray: CV_8UC1, not empty.
cv::Mat Manipulate(const cv::Mat& gray, Condition condition, std::uint32_t seed);

/// Where a point of the image is in the copy, px.
cv::Point2f PointInCopy(const cv::Point2f& position, Condition condition, const cv::Size& size);

}  // namespace floorloc
