// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

FloorCamera CameraOf(const BuildFrame& frame, const std::vector<LoadedSurvey>& surveys) {
  return surveys[static_cast<std::size_t>(frame.survey)].survey.camera.AtHeight(frame.height_ratio);
}

Eigen::Vector2d FloorPointOf(const BuildFrame& frame, const std::vector<LoadedSurvey>& surveys,
                             const Eigen::Vector2d& raw_px) {
  return FloorWhileMoving(CameraOf(frame, surveys), raw_px, frame.readout_motion);
}

Eigen::Vector2d RawPixelOf(const BuildFrame& frame, const std::vector<LoadedSurvey>& surveys,
                           const Eigen::Vector2d& point_in_base_m) {
  return RawPixelWhileMoving(CameraOf(frame, surveys), point_in_base_m, frame.readout_motion);
}

std::vector<RectM> FloorsInBase(const std::vector<BuildFrame>& frames, const std::vector<LoadedSurvey>& surveys) {
  std::vector<RectM> floors;
  floors.reserve(frames.size());
  for (const BuildFrame& frame : frames) {
    floors.push_back(CameraOf(frame, surveys).floor.roi);
  }
  return floors;
}

std::vector<RectM> FrameSet::FloorsInBase() const { return floorloc::FloorsInBase(frames, surveys); }

}  // namespace floorloc
