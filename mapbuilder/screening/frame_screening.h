// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/placement/pair_registration.h"
#include "mapbuilder/survey/build_frame.h"
#include "mapbuilder/survey/dropped_frame.h"

namespace floorloc {

/// Frames that are suitable for a map, and the dropped ones with reasons.
struct ScreenedFrames {
  FrameSet kept;
  std::vector<DroppedFrame> dropped;
  std::vector<std::string> warnings;  ///< one sentence each
};

/// Drops frames that would harm the map or add nothing to it: unreadable, too dark, overexposed, without texture, much
/// less sharp than the frames around them, repeated during standstill; and their control points. Throws InputError when
/// too many images are unreadable or no frame is left.
ScreenedFrames ScreenFrames(FrameSet set, const PairRegistrationOptions& registration);

}  // namespace floorloc
