// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/mosaic/mosaic_patch.h"
#include "mapbuilder/placement/link.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

/// Gains that make a rectified image independent of camera and illumination.
struct Exposure {
  std::vector<double> frame_gain;        ///< per frame
  std::vector<cv::Vec3f> white_balance;  ///< per frame: factors of (B, G, R); may be empty
  std::vector<cv::Mat> flat_field;       ///< per survey: CV_32F gain of every pixel of the rectified image
  std::vector<cv::Mat> cell_colors;      ///< per frame, from MeasureCellColors(); may be empty

  /// Factors of (B, G, R) of a frame.
  cv::Vec3f GainOf(std::size_t frame) const;
};

struct ExposureInput {
  const std::vector<BuildFrame>& frames;
  const std::vector<LoadedSurvey>& surveys;
  const std::vector<Link>& links;
  const std::vector<std::optional<Pose2>>& map_from_base;
  MosaicBackground background = nullptr;  ///< image whose exposure the frames shall match; may be empty
  RunOptions run = {};
};

/// Estimates flat fields (vignetting and lamps that ride on the robot) from the median over each survey's frames, then
/// gains per frame and channel from the floor that linked frames share, within and across surveys, by robust least
/// squares on log gains, so that shadows and fixed lamps count little. Throws InputError for an unreadable image.
Exposure EstimateExposure(const ExposureInput& input);

}  // namespace floorloc
