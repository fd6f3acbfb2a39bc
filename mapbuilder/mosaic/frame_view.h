// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <opencv2/core/mat.hpp>

#include "core/geometry/pose2.h"
#include "core/vision/image/rectifier.h"
#include "mapbuilder/mosaic/mosaic_grid.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

/// What all frames of a survey share.
struct SurveyView {
  std::shared_ptr<const Rectifier> rectifier;
  cv::Mat depth;      ///< CV_32F, of the rectified image: distance in pixels to the border of the valid area; 0 outside
  cv::Mat flat_gain;  ///< CV_32F, of the rectified image

  SurveyView(const LoadedSurvey& survey, cv::Mat flat_gain);
};

/// Geometry of a placed frame for resampling into the mosaic.
class FrameView {
 public:
  /// Points in the base frame are those of the calibrated camera, also where the frame's own height differs.
  FrameView(const SurveyView& survey, const Pose2& map_from_base, const BuildFrame& frame);

  Eigen::Vector2d BaseFromMap(const Eigen::Vector2d& p) const { return base_from_map_ * p; }
  Eigen::Vector2d MapFromBase(const Eigen::Vector2d& p) const { return map_from_base_ * p; }
  /// Nodes that the frame can affect, with a margin of one on each side; may be empty.
  cv::Rect Footprint(const MosaicGrid& grid) const;
  /// Width of the view's border, in pixels of the rectified image, within which a cell may extend beyond the view.
  float BorderPx(const MosaicGrid& grid) const;
  /// Depth of a map point inside the frame's view: distance to its border, pixels of the rectified image; 0 outside.
  float Depth(const Eigen::Vector2d& point_in_map) const;
  /// Flat-field gain at the point; 1 outside the view.
  float FlatGain(const Eigen::Vector2d& point_in_map) const;
  /// Raw pixel of a map point; a position far outside the image when the camera does not see it.
  cv::Vec2f RawPixel(const Eigen::Vector2d& point_in_map) const;

 private:
  float SampleRectified(const cv::Mat& image, const Eigen::Vector2d& point_in_map, float outside) const;

  const SurveyView* survey_;
  Eigen::Affine2d map_from_base_;  // with the scale of the frame's own height
  Eigen::Affine2d base_from_map_;
  Eigen::Vector3d camera_center_;   // base frame, metres
  Eigen::Vector4d mounting_error_;  // rotation, height share
  Eigen::Vector3d readout_motion_;  // BuildFrame::readout_motion
};

}  // namespace floorloc
