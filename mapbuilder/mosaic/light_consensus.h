// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/coverage/frame_index.h"
#include "mapbuilder/mosaic/frame_light.h"
#include "mapbuilder/mosaic/frame_view.h"
#include "mapbuilder/mosaic/mosaic_input.h"

namespace floorloc {

/// What to multiply a frame's picture with, place by place.
struct FrameGain {
  cv::Vec3f even;     ///< of the whole frame: blue, green, red
  cv::Mat local_log;  ///< CV_32FC3 per cell of the light grid, logarithms; may be empty
  const LightGrid* grid = nullptr;

  /// The flat field included.
  cv::Vec3f At(const FrameView& view, const Eigen::Vector2d& point_in_map) const;
};

/// Frames of one floor show it in different light: shadows and lamps that the robot passed. Where several frames see a
/// place, most of them agree on its brightness; this gives what each frame has to be multiplied with to agree too. The
/// brightness is a robust mean (Geman & McClure), weighted by how deep the place lies in each frame's view, so that it
/// is the same from whichever frame it is asked, and continuous over the floor.
class LightConsensus {
 public:
  /// All must outlive it.
  LightConsensus(const MosaicInput& input, const FrameIndex& index, const std::vector<SurveyView>& surveys);

  FrameGain GainOf(int frame) const;

 private:
  struct Opinion {
    cv::Vec3f log_color;
    float weight = 0.0F;
  };
  std::optional<Opinion> Ask(int frame, const FrameView& view, const Eigen::Vector2d& point_in_map) const;
  FrameView ViewOf(int frame) const;
  std::size_t SurveyOf(int frame) const {
    return static_cast<std::size_t>(input_.frames[static_cast<std::size_t>(frame)].survey);
  }
  static cv::Vec3f Agree(const std::vector<Opinion>& opinions);

  const MosaicInput& input_;
  const FrameIndex& index_;
  const std::vector<SurveyView>& surveys_;
  std::vector<LightGrid> grids_;
};

}  // namespace floorloc
