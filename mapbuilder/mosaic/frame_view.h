// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <opencv2/core/mat.hpp>

#include "core/geometry/pose2.h"
#include "core/vision/image/rectifier.h"
#include "mapbuilder/mosaic/mosaic_grid.h"
#include "mapbuilder/survey/survey_frames.h"

namespace floorloc {

/// What all frames of a survey have in common.
struct SurveyView {
  std::shared_ptr<const Rectifier> rectifier;
  cv::Mat depth;      ///< CV_32F, of the rectified image: pixels to the border of what is seen; 0 outside
  cv::Mat flat_gain;  ///< CV_32F, of the rectified image

  SurveyView(const LoadedSurvey& survey, cv::Mat flat_gain);
};

/// A placed frame, seen from the mosaic.
class FrameView {
 public:
  FrameView(const SurveyView& survey, const Pose2& map_from_base);

  Eigen::Vector2d BaseFromMap(const Eigen::Vector2d& p) const { return base_from_map_ * p; }
  Eigen::Vector2d MapFromBase(const Eigen::Vector2d& p) const { return map_from_base_ * p; }
  /// The nodes that the frame can touch, one more at each side; may be empty.
  cv::Rect Footprint(const MosaicGrid& grid) const;
  /// Cells that come nearer to the view's border than this reach across it, pixels of the rectified image.
  float BorderPx(const MosaicGrid& grid) const;
  /// How far inside the frame's view a map point lies, pixels of the rectified image; 0 outside.
  float Depth(const Eigen::Vector2d& point_in_map) const;
  /// Gain of the flat field there; 1 outside.
  float FlatGain(const Eigen::Vector2d& point_in_map) const;
  /// Outside the image where the camera does not see the point.
  cv::Vec2f RawPixel(const Eigen::Vector2d& point_in_map) const;

 private:
  float SampleRectified(const cv::Mat& image, const Eigen::Vector2d& point_in_map, float outside) const;

  const SurveyView* survey_;
  Eigen::Isometry2d map_from_base_;
  Eigen::Isometry2d base_from_map_;
};

}  // namespace floorloc
