// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapbuilder/placement/pair_registration.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

struct OdometryStepOptions {
  /// A step that images can't confirm is false when it is farther than a view and this many times as fast as 90 % of
  /// the steps. Drives that stop and go keep below 1.4 (simulate --trajectory drive --speed-variation 0.9 --stops 2).
  double max_times_usual = 5.0;
  /// On floors that repeat themselves images count against odometry only if it is this many times as fast.
  double max_times_usual_if_repetitive = 1.5;
  /// Odometry that is at most this many times as fast as the others stands still.
  double max_times_standing = 0.1;
  /// So many steps in a row that stand still and whose images do not match are false: one blurred image makes two.
  int min_standing_steps = 3;
  /// Messages name at most this many steps of a survey.
  int named = 3;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// A motion of odometry between frames next to each other in time that the robot did not make.
struct FalseOdometryStep {
  int first = 0;  ///< frame
  int second = 0;
  Pose2 by_odometry;               ///< first_from_second
  std::optional<Pose2> by_images;  ///< empty: the images show no common floor
  double times_usual = 0.0;        ///< its speed over that of the others
  bool standing = false;           ///< odometry stood still
};

/// Registers all neighbours in time, first around odometry's motion, then anywhere. On repetitive floors, where images
/// alone may be off by a period, only steps that are also faster than the others count as false. Sorted by frame.
std::vector<FalseOdometryStep> FindFalseOdometrySteps(const FrameSet& set, const PairRegistrationOptions& registration,
                                                      const OdometryStepOptions& options);

/// Takes the steps out of the frames' and the surveys' odometry: what follows moves rigidly to where the images put it,
/// or without those on from where it was, marked as a break.
FrameSet WithoutSteps(FrameSet set, const std::vector<FalseOdometryStep>& steps);

/// Finds the false steps, takes them out, and names them, one sentence for each step or span at a standstill.
std::vector<std::string> MendOdometry(const PairRegistrationOptions& registration, const OdometryStepOptions& options,
                                      FrameSet* set);

}  // namespace floorloc
