// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

/// ReadoutMotion::motion of a survey's frame by its odometry. Zero: a global shutter, an unknown read-out, or no
/// odometry at its time.
Eigen::Vector3d ReadoutMotionByOdometry(const Survey& survey, const SurveyFrame& frame);

/// True when the survey's rows are exposed one after the other and it has no odometry that tells its motion.
bool NeedsMotionByImages(const Survey& survey);

/// Sets BuildFrame::readout_motion of the survey's frames, in order of time, to the mean velocity from and to their
/// neighbours, where their features show it. Returns the frames that have one, whose features are to be extracted anew.
std::vector<int> SetReadoutMotionByImages(const LoadedSurvey& loaded, int survey, std::vector<BuildFrame>* frames);

}  // namespace floorloc
