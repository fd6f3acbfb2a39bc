// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/localization/moving_frame.h"

namespace floorloc {

/// What a person looks at to see why an image was localized, or was not.
struct Inspection {
  static constexpr std::size_t kMaxPoses = 4;  ///< that are worth a look: that of the answer and its rivals

  RectM region;                     ///< of the base frame, that the image covers
  std::vector<std::uint8_t> image;  ///< PNG, the floor from above: +x up, +y left; transparent where none is seen
  std::vector<Eigen::Vector2d> keypoints;  ///< base frame
  std::vector<CompetingPose> poses;        ///< Localizer::Compete
};

/// raw and rectifier: of the frame, as ObserveAndLocalize had them. Takes about as long as localizing it.
Inspection Inspect(const Localizer& localizer, const Rectifier& rectifier, const cv::Mat& raw,
                   const ObservedFrame& frame);

}  // namespace floorloc
