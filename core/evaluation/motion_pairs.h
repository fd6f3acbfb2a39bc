// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "core/io/trajectory.h"

namespace floorloc {

/// Unit of the length of a motion.
enum class DeltaUnit {
  kFrames,   ///< rows of the trajectory
  kMetres,   ///< of the path driven
  kSeconds,  ///< of time
  kRadians,  ///< of turning
};

/// Selection of the motions that the relative pose error compares.
struct MotionOptions {
  double delta = 1.0;  ///< length of a motion; a whole number of frames, at most pi radians
  DeltaUnit unit = DeltaUnit::kFrames;
  bool all_pairs = false;  ///< motions may overlap: one (or more) from every pose, instead of one after the other
  double relative_tolerance = 0.1;  ///< of the length, for motions that must have it: see SelectMotions

  /// Throws std::invalid_argument.
  void Check() const;
};

/// A motion from one pose of a trajectory to a later one, by their indices.
struct Motion {
  std::size_t from = 0;
  std::size_t to = 0;

  bool operator==(const Motion&) const = default;
};

/// The motions of a trajectory as defined by the trajectory tool evo, with seconds as an additional unit:
/// - frames: from every delta-th pose to the next of these; all pairs: from every pose.
/// - metres: a motion ends where the path since its start reaches delta and the next one starts there; the first one
///   starts where the path reaches delta for the first time. All pairs: from every pose to that at the path nearest to
///   delta, within the tolerance.
/// - radians: as for metres with the turning summed up from pose to pose, but from the first pose. All pairs: every two
///   poses whose headings differ by delta within the tolerance, directly.
/// - seconds: to the pose at the time nearest to delta, within the tolerance; the next one starts there, or one pose
///   later where there is none. All pairs: from every pose.
std::vector<Motion> SelectMotions(const Trajectory& trajectory, const MotionOptions& options);

}  // namespace floorloc
