// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/screening/odometry_steps.h"

namespace floorloc {

/// A step of odometry that the images did not confirm.
struct OpenStep {
  FramePair pair;  ///< with odometry's motion
  std::optional<Pose2>
      by_images;             ///< first_from_second; empty: the images show no common floor, or may be a period off
  double times_usual = 0.0;  ///< its speed over that of the others
};

/// What steps are registered with.
struct StepRegistration {
  const std::vector<BuildFrame>& frames;
  const std::vector<RectM>& floors;
  const PairRegistrationOptions& options;
};

/// Steps within spans in which odometry stands still and the robot does not: images show that it moved, or several in a
/// row do not match although odometry says that they show the same floor. Where the robot went is looked for on from
/// its last motion; what is not found there has no `by_images`. `open` and the result are sorted by frame.
std::vector<FalseOdometryStep> FindStandingSteps(const std::vector<OpenStep>& open,
                                                 const StepRegistration& registration,
                                                 const OdometryStepOptions& options);

}  // namespace floorloc
