// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/lattice/lattice_observation.h"
#include "core/localization/pose_prior.h"
#include "core/registration/registration.h"
#include "core/tracking/lattice_weights.h"
#include "core/tracking/seen_floor.h"

namespace floorloc {

/// How places that look alike are told apart by driving. `./run bench ambiguity`.
struct LatticeTrackerOptions {
  /// Standard deviation of the motion between observations: of the path, of the turn, and whatever they are.
  double motion_share = 0.03;
  double motion_sigma_m = 0.01;
  double turn_share = 0.05;
  double yaw_sigma_rad = 0.02;
  /// Motion that is less certain than this share of the shortest period does not tell which place follows which.
  double max_motion_share = 0.35;
  /// Probability per metre of path that a vehicle slips by whole periods, which no frame shows: one in a thousand
  /// kilometres.
  double slip_per_m = 1e-6;
  /// Probability per frame that the vehicle is moved, and at the start that it is on no place of the lattice.
  double kidnap_per_frame = 1e-6;
  double elsewhere_at_start = 1e-3;
  /// Likelihood that a view of new floor is beyond the map's border, where the survey has seen nothing, relative to one
  /// within it.
  double beyond_border = 0.1;
  /// Prior standard deviation of the ratio between a place's score (LatticePlace::sigma) and the expected one: worn
  /// floor and noise that is not independent make it less than 1.
  double gain_sigma = 0.5;
  /// Exponent of the likelihoods of scores, as LatticeComparisonOptions::temper: worn floor is no normal noise.
  double temper = 0.5;
  double max_p_wrong = 1e-4;  ///< a place that is wrong with a higher probability is not told
  /// A vehicle that is less probably elsewhere is at no other place that would be worth a list.
  double sure_p_elsewhere = 1e-6;
  std::size_t max_views = 100;    ///< whose floor is remembered
  std::size_t max_places = 5000;  ///< that are listed; of larger maps, those that were compared
  std::size_t max_hypotheses = 8;
  double min_weight = 0.01;  ///< of a hypothesis that is told

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// The pose of a frame at the place of the lattice where the drive says that it is.
struct LatticeFix {
  Pose2 map_from_base;
  double p_wrong = 1.0;
};

/// At which place of a lattice a vehicle is, where frames look alike at many: the frames of a drive together. Each
/// frame measures the pose modulo the lattice; every place has a probability, which moves with the vehicle
/// (LatticeWeights). Floor that was seen before counts no more. Whether the vehicle is at any place at all is one more
/// hypothesis, which wins where the motion between frames fits none: it was moved, or set to a wrong pose. One rule for
/// all of them.
class LatticeTracker {
 public:
  explicit LatticeTracker(const LatticeTrackerOptions& options = {});

  /// The base moved since the last call, or the last frame.
  void Move(const Pose2& motion);
  /// It moved, nobody knows how.
  void LoseMotion() { motion_known_ = false; }
  /// Adds a frame. Returns its pose when the place is sure.
  std::optional<LatticeFix> Add(const LatticeObservation& observation);
  /// Adds a frame that alone tells its place. p_wrong: of that.
  void AddLocalized(const LatticeObservation& observation, const Pose2& map_from_base, double p_wrong);

  /// The likeliest places where the vehicle is now, the likeliest first; empty: there was no frame yet.
  std::vector<PoseHypothesis> Hypotheses() const;
  /// Probability that it is not at the likeliest place; empty: there was no frame yet.
  std::optional<double> PElsewhere() const;
  /// The likeliest place after a further motion, with radii of so many standard deviations; empty: there was no frame
  /// yet, or the motion is too uncertain to tell where it is on the lattice.
  std::optional<PosePrior> Prior(const Pose2& motion, double sigmas) const;
  /// Shortest period, metres; 0: there was no frame yet.
  double Period() const;

 private:
  // The motion since the last frame.
  struct Motion {
    Pose2 last_from_now;
    double path_m = 0.0;
    double turn_rad = 0.0;

    void Add(const Pose2& step);
  };

  double PositionSigma(const Motion& motion) const;
  double YawSigma(const Motion& motion) const;
  double Advance(const LatticeObservation& observation);
  bool Follow(const LatticeObservation& observation);
  void Start(const LatticeObservation& observation);
  void Weigh(const LatticeObservation& observation, double news);
  Pose2 PoseAt(const Eigen::Vector2i& at) const;
  Eigen::Vector2i PlaceOf(const Pose2& map_from_base) const;
  bool IsOnMap(const Eigen::Vector2i& at) const;

  LatticeTrackerOptions options_;
  std::optional<LatticeObservation> last_;  // without its places
  Pose2 anchor_;                            // pose of the base, at the last frame, at the place (0, 0)
  Motion motion_;
  bool motion_known_ = true;
  LatticeWeights weights_;
  SeenFloor seen_;
};

}  // namespace floorloc
