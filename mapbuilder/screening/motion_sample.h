// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "mapbuilder/placement/pair_registration.h"
#include "mapbuilder/screening/odometry_reading.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

/// Motions of a sample of pairs, odometry's multiplied by a unit where its lengths are of another order than vision's.
struct MeasuredMotions {
  std::vector<MotionPair> motions;
  double unit = 1.0;
};

/// Registers pairs of a survey's frames without odometry: in the driving direction, by odometry's lengths or, where
/// those choose none that match, by time; and to neighbouring lanes. floor: the region of interest, base frame.
MeasuredMotions MeasureMotions(const std::vector<BuildFrame>& frames, int survey, const RectM& floor,
                               PairRegistrationOptions registration);

}  // namespace floorloc
