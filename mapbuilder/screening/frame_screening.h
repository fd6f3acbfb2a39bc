// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/placement/pair_registration.h"
#include "mapbuilder/survey/dropped_frame.h"
#include "mapbuilder/survey/survey_frames.h"

namespace floorloc {

/// The frames that are good for a map, and what was found wrong with the others.
struct ScreenedFrames {
  FrameSet kept;
  std::vector<DroppedFrame> dropped;
  std::vector<std::string> warnings;  ///< sentences
};

/// Takes frames out that would harm the map or add nothing to it: unreadable, too dark, overexposed, without texture,
/// much less sharp than the frames around them, repeated while the robot stood still; with them go their control
/// points. Throws InputError when more than a few images can't be read, or no frame is left.
ScreenedFrames ScreenFrames(FrameSet set, const PairRegistrationOptions& registration);

}  // namespace floorloc
