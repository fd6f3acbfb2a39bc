// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/coverage/frame_index.h"
#include "mapbuilder/mosaic/exposure_grid.h"
#include "mapbuilder/mosaic/frame_view.h"
#include "mapbuilder/mosaic/mosaic_input.h"

namespace floorloc {

/// Gain of a frame's image, position by position.
struct FrameGain {
  cv::Vec3f uniform;  ///< of the whole frame: blue, green, red
  cv::Mat local_log;  ///< CV_32FC3 per cell of the exposure grid, logarithms; may be empty
  const ExposureGrid* grid = nullptr;

  /// The flat field included.
  cv::Vec3f At(const FrameView& view, const Eigen::Vector2d& point_in_map) const;
};

/// Frames of one floor show it under different illumination: shadows and lamps that the robot passed. Where several
/// frames see a place, most of them agree on its brightness; this gives what each frame has to be multiplied with to
/// agree too. The brightness is a robust mean (Geman & McClure), weighted by how deep the place lies in each frame's
/// view, so that it is independent of the frame and continuous over the floor.
class ExposureField {
 public:
  /// All must outlive it.
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
