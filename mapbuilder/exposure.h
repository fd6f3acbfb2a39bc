// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "mapbuilder/pair_registration.h"
#include "mapbuilder/survey_frames.h"

namespace floorloc {

/// What to multiply a rectified picture with, so that the mosaic shows the floor and not the camera.
struct Exposure {
  std::vector<double> frame_gain;   ///< per frame
  std::vector<cv::Mat> flat_field;  ///< per survey: CV_32F gain of every pixel of the rectified picture
};

/// Vignetting and lamps that ride on the robot from the mean of all frames; then one gain per frame from the brightness
/// of the floor that linked frames share (least squares on log gains).
Exposure EstimateExposure(const std::vector<BuildFrame>& frames, const std::vector<LoadedSurvey>& surveys,
                          const std::vector<Link>& links);

}  // namespace floorloc
