// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/geometry/pose2.h"

namespace floorloc {

/// Motion between two frames of a survey by odometry and by vision: first_from_second of the view's centre, which is
/// invariant when a homography is rotated, mirrored or scaled about it.
struct MotionPair {
  Pose2 by_odometry;
  Pose2 by_vision;
  double heading_rad = 0.0;  ///< of the first frame by odometry, in its own frame
  double travelled_m = 0.0;  ///< between the frames by odometry, which drifts on the way; 0: no more than the motion
};

/// What a file of poses may mean other than it says.
enum class OdometryReading {
  kAsSaid,
  kMirrored,           ///< positions and headings are left-handed
  kPositionsMirrored,  ///< positions are left-handed (x and y exchanged, or one of them negated), headings are not
  kHeadingsMirrored,   ///< headings count clockwise, positions are right-handed
  kDegrees,            ///< headings are degrees, written as if they were radians
  kStandingHeadings,   ///< headings stay as they are, or are radians written as if they were degrees
};

/// The sigmas are wheels', as OdometryClockOptions', and grow with the way between the frames.
struct OdometryReadingOptions {
  double sigma_m = 0.002;
  double sigma_rad = 0.003;
  double sigma_share = 0.03;      ///< of the motion or the turn
  double drift_share = 0.015;     ///< of the way: wheels drift by 1 to 2 %
  double drift_rad_per_m = 0.01;  ///< simulate's wheels: 2 degrees over 16 m
  double lever_m = 0.02;          ///< of the base frame against what the robot turns about: an offset of the mounting
  double min_length_m = 0.02;     ///< shorter motions do not determine scale and direction
  /// In a tight turn, an offset of the base frame of a few centimetres changes length and direction of the motion.
  double max_turn_rad = 0.15;
  /// Only motions tell two readings apart whose predictions differ by this, in squared sigmas: twice what noise alone
  /// makes of 3 degrees of freedom.
  double min_change = 6.0;
  int min_telling = 5;  ///< such motions, before a reading is believed
  /// Share of the squared residuals that a reading may leave of those without it: a third of wrong motions by vision,
  /// as on floors that repeat themselves, leaves 0.35.
  double max_left = 0.5;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Agreement of motions by vision with those of odometry. Medians, so that single wrong motions have no influence.
struct MotionAgreement {
  int motions = 0;                                     ///< number compared; if 0 the other fields are not valid
  OdometryReading reading = OdometryReading::kAsSaid;  ///< the one that fits
  // Under that reading:
  double scale = 1.0;          ///< length by vision over length by odometry
  double direction_rad = 0.0;  ///< from odometry's direction of motion to vision's, counter-clockwise
  double scatter = 0.0;        ///< residual after scale and direction, share of the motion
};

/// Finds the reading of odometry under which its motions are those of the images. Another than what it says is believed
/// only where it fits much better.
MotionAgreement CompareMotions(const std::vector<MotionPair>& motions, const OdometryReadingOptions& options = {});

}  // namespace floorloc
