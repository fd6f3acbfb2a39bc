// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

std::vector<RectM> FrameSet::FloorsInBase() const {
  std::vector<RectM> floors;
  floors.reserve(frames.size());
  for (const BuildFrame& frame : frames) {
    floors.push_back(surveys[static_cast<std::size_t>(frame.survey)].survey.camera.floor.roi);
  }
  return floors;
}

}  // namespace floorloc
