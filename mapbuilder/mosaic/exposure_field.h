// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/coverage/frame_index.h"
#include "mapbuilder/mosaic/exposure_grid.h"
#include "mapbuilder/mosaic/frame_view.h"
#include "mapbuilder/mosaic/mosaic_input.h"

namespace floorloc {

/// Position-dependent gain of a frame's image.
struct FrameGain {
  cv::Vec3f uniform;  ///< (B, G, R) of the whole frame
  cv::Mat local_log;  ///< CV_32FC3 per cell of the exposure grid, log gain; may be empty
  const ExposureGrid* grid = nullptr;

  /// (B, G, R) including the flat field.
  cv::Vec3f At(const FrameView& view, const Eigen::Vector2d& point_in_map) const;
};

/// Local gain correction of overlapping frames. Shadows and lamps that the robot passed make frames of one floor differ
/// in brightness; where several frames overlap, most agree. GainOf() gives the factors that bring each frame to the
/// common brightness, a robust mean (Geman & McClure) weighted by the depth of the point inside each frame's view. It
/// is the same for all frames and continuous over the floor.
class ExposureField {
 public:
  /// All arguments must outlive it.
  ExposureField(const MosaicInput& input, const FrameIndex& index, const std::vector<SurveyView>& surveys);

  FrameGain GainOf(int frame) const;

 private:
  struct ColorSample {
    cv::Vec3f log_color;
    float weight = 0.0F;
  };
  std::optional<ColorSample> SampleFrame(int frame, const FrameView& view, const Eigen::Vector2d& point_in_map) const;
  FrameView ViewOf(int frame) const;
  std::size_t SurveyOf(int frame) const {
    return static_cast<std::size_t>(input_.frames[static_cast<std::size_t>(frame)].survey);
  }
  static cv::Vec3f RobustMean(const std::vector<ColorSample>& samples);

  const MosaicInput& input_;
  const FrameIndex& index_;
  const std::vector<SurveyView>& surveys_;
  std::vector<ExposureGrid> grids_;
};

}  // namespace floorloc
