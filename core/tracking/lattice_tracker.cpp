// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/lattice_tracker.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

double LogNormalDensity(const Eigen::Vector2d& residual_m, const Eigen::Matrix2d& covariance) {
  return -0.5 * residual_m.dot(covariance.inverse() * residual_m) - 0.5 * std::log(covariance.determinant()) -
         std::log(2.0 * std::numbers::pi);
}

double CellArea(const FloorLattice& lattice) { return std::abs(lattice.basis.determinant()); }

double PeriodOf(const FloorLattice& lattice) {
  return std::min(lattice.basis.col(0).norm(), lattice.basis.col(1).norm());
}

}  // namespace

void LatticeTrackerOptions::Check() const {
  RequireOption(motion_share >= 0.0, "motion_share must not be negative");
  RequireOption(motion_sigma_m > 0.0, "motion_sigma_m must be positive");
  RequireOption(turn_share >= 0.0, "turn_share must not be negative");
  RequireOption(yaw_sigma_rad > 0.0, "yaw_sigma_rad must be positive");
  RequireOption(max_motion_share > 0.0 && max_motion_share <= 1.0, "max_motion_share must be above 0 and at most 1");
  RequireOption(slip_per_m > 0.0 && slip_per_m < 0.1, "slip_per_m must be above 0 and below 0.1");
  RequireOption(kidnap_per_frame > 0.0 && kidnap_per_frame < 0.1, "kidnap_per_frame must be above 0 and below 0.1");
  RequireOption(elsewhere_at_start > 0.0 && elsewhere_at_start < 1.0, "elsewhere_at_start must be between 0 and 1");
  RequireOption(beyond_border > 0.0 && beyond_border <= 1.0, "beyond_border must be above 0 and at most 1");
  RequireOption(gain_sigma > 0.0, "gain_sigma must be positive");
  RequireOption(temper > 0.0 && temper <= 1.0, "temper must be above 0 and at most 1");
  RequireOption(max_p_wrong > 0.0 && max_p_wrong < 1.0, "max_p_wrong must be between 0 and 1");
  RequireOption(sure_p_elsewhere > 0.0 && sure_p_elsewhere <= max_p_wrong,
                "sure_p_elsewhere must be above 0 and at most max_p_wrong");
  RequireOption(max_views >= 1, "max_views must be positive");
  RequireOption(max_places >= 1, "max_places must be positive");
  RequireOption(max_hypotheses >= 1, "max_hypotheses must be positive");
  RequireOption(min_weight > 0.0 && min_weight < 1.0, "min_weight must be between 0 and 1");
}

LatticeTracker::LatticeTracker(const LatticeTrackerOptions& options)
    : options_((options.Check(), options)), weights_(options.gain_sigma), seen_(options.max_views) {}

void LatticeTracker::Motion::Add(const Pose2& step) {
  last_from_now = last_from_now * step;
  path_m += step.translation().norm();
  turn_rad += std::abs(step.yaw());
}

void LatticeTracker::Move(const Pose2& motion) { motion_.Add(motion); }

double LatticeTracker::PositionSigma(const Motion& motion) const {
  return std::hypot(options_.motion_sigma_m, options_.motion_share * motion.path_m);
}

double LatticeTracker::YawSigma(const Motion& motion) const {
  return std::hypot(options_.yaw_sigma_rad, options_.turn_share * motion.turn_rad);
}

double LatticeTracker::Period() const { return last_ ? PeriodOf(last_->lattice) : 0.0; }

Pose2 LatticeTracker::PoseAt(const Eigen::Vector2i& at) const {
  const Eigen::Vector2d t = anchor_.translation() + last_->lattice.basis * at.cast<double>();
  return {t.x(), t.y(), anchor_.yaw()};
}

Eigen::Vector2i LatticeTracker::PlaceOf(const Pose2& map_from_base) const {
  return last_->lattice.Nearest(map_from_base.translation() - anchor_.translation());
}

bool LatticeTracker::IsOnMap(const Eigen::Vector2i& at) const {
  return last_->map_extent.Contains(PoseAt(at) * last_->view_center);
}

// Every place of the map is as likely.
void LatticeTracker::Start(const LatticeObservation& observation) {
  seen_.Clear();
  last_ = observation;
  anchor_ = observation.map_from_base;
  const RectM& extent = observation.map_extent;
  const double on_map = std::max(1.0, extent.width_m() * extent.height_m() / CellArea(observation.lattice));
  std::vector<Eigen::Vector2i> listed;
  if (on_map <= static_cast<double>(options_.max_places)) {
    const Eigen::Matrix2d inverse = observation.lattice.basis.inverse();
    const double reach_m = std::hypot(extent.width_m(), extent.height_m());
    const int across = static_cast<int>(std::ceil(reach_m * inverse.row(0).norm()));
    const int along = static_cast<int>(std::ceil(reach_m * inverse.row(1).norm()));
    for (int i = -across; i <= across; ++i) {
      for (int k = -along; k <= along; ++k) {
        if (IsOnMap({i, k})) {
          listed.emplace_back(i, k);
        }
      }
    }
  }
  const double count = listed.empty() ? on_map : static_cast<double>(listed.size());
  if (listed.empty()) {
    listed.emplace_back(0, 0);
  }
  weights_.Start(listed, count, options_.elsewhere_at_start);
}

// Compares the frame with the motion since the last one. False: it is at no place where the vehicle can be.
bool LatticeTracker::Follow(const LatticeObservation& observation) {
  const double sigma_m = PositionSigma(motion_);
  if (!motion_known_ || sigma_m > options_.max_motion_share * PeriodOf(observation.lattice)) {
    return false;
  }
  const Pose2 predicted = anchor_ * motion_.last_from_now;
  const Eigen::Vector2d apart = observation.map_from_base.translation() - predicted.translation();
  const Eigen::Vector2d whole = observation.lattice.basis * observation.lattice.Nearest(apart).cast<double>();
  const Eigen::Matrix2d covariance =
      sigma_m * sigma_m * Eigen::Matrix2d::Identity() + observation.covariance.topLeftCorner<2, 2>();
  const double log_stays = LogNormalDensity(apart - whole, covariance);
  std::vector<std::pair<Eigen::Vector2i, double>> steps;
  for (int i = -1; i <= 1; ++i) {
    for (int k = -1; k <= 1; ++k) {
      const Eigen::Vector2i step(i, k);
      const double log_density =
          LogNormalDensity(apart - whole + observation.lattice.basis * step.cast<double>(), covariance);
      if (!step.isZero() && log_density > log_stays + std::log(options_.slip_per_m)) {
        steps.emplace_back(step, log_density);
      }
    }
  }
  weights_.Spread(log_stays, steps);
  // Of a vehicle that was moved, any position in a cell and any heading are as likely.
  const double yaw_sigma = YawSigma(motion_);
  const double yaw_sigmas = WrapAngle(observation.map_from_base.yaw() - predicted.yaw()) / yaw_sigma;
  const double log_yaw = -0.5 * yaw_sigmas * yaw_sigmas - std::log(yaw_sigma * std::sqrt(2.0 * std::numbers::pi));
  const double log_anywhere = -std::log(2.0 * std::numbers::pi * CellArea(observation.lattice));
  weights_.WeighElsewhere(log_anywhere - log_yaw, options_.kidnap_per_frame);
  const Eigen::Vector2d t = observation.map_from_base.translation() - whole;
  anchor_ = Pose2(t.x(), t.y(), observation.map_from_base.yaw());
  return weights_.ProbabilityOfNone() < 0.5;
}

// Moves on to the time of the frame. Returns the share of its view that was not seen before.
double LatticeTracker::Advance(const LatticeObservation& observation) {
  if (last_ && Follow(observation)) {
    weights_.Slip(std::min(0.5, options_.slip_per_m * motion_.path_m));
    last_ = observation;
  } else {
    Start(observation);
  }
  last_->places.clear();
  motion_ = Motion();
  motion_known_ = true;
  return observation.by_prior ? 0.0 : seen_.Add(PoseAt({0, 0}) * observation.view_center, observation.view_area_m2);
}

// By the scores of the places and by the map's border.
void LatticeTracker::Weigh(const LatticeObservation& observation, double news) {
  const Eigen::Vector2i origin = PlaceOf(observation.map_from_base);
  for (const LatticePlace& compared : observation.places) {
    weights_.AddScore(origin + compared.multiples, compared.sigma, compared.expected_sigma, options_.temper * news);
  }
  for (const LatticeWeights::Weight& place : weights_.Listed()) {
    if (!IsOnMap(place.at)) {
      weights_.Multiply(place.at, news * std::log(options_.beyond_border));
    }
  }
}

std::optional<LatticeFix> LatticeTracker::Add(const LatticeObservation& observation) {
  if (observation.p_wrong > options_.max_p_wrong) {
    return std::nullopt;
  }
  Weigh(observation, Advance(observation));
  LatticeFix fix;
  double p_elsewhere = 1.0;
  const Eigen::Vector2i best = weights_.Best(&p_elsewhere);
  fix.map_from_base = PoseAt(best);
  fix.p_wrong = std::min(1.0, p_elsewhere + observation.p_wrong);
  const Eigen::Vector2i multiples = best - PlaceOf(observation.map_from_base);
  for (const LatticePlace& compared : observation.places) {
    if (compared.multiples == multiples) {
      fix.map_from_base = compared.map_from_base;
    }
  }
  weights_.Shorten(options_.sure_p_elsewhere, options_.kidnap_per_frame * options_.sure_p_elsewhere);
  return fix.p_wrong <= options_.max_p_wrong ? std::optional(fix) : std::nullopt;
}

void LatticeTracker::AddLocalized(const LatticeObservation& observation, const Pose2& map_from_base, double p_wrong) {
  const double news = Advance(observation);
  weights_.MultiplyOthers(PlaceOf(map_from_base), news * std::log(std::clamp(p_wrong, 1e-12, 1.0)));
  weights_.Shorten(options_.sure_p_elsewhere, options_.kidnap_per_frame * options_.sure_p_elsewhere);
}

std::vector<PoseHypothesis> LatticeTracker::Hypotheses() const {
  std::vector<PoseHypothesis> hypotheses;
  for (const LatticeWeights::Weight& place : weights_.Listed()) {
    if (place.probability >= options_.min_weight) {
      hypotheses.push_back({PoseAt(place.at) * motion_.last_from_now, 0, place.probability});
    }
  }
  std::stable_sort(hypotheses.begin(), hypotheses.end(),
                   [](const PoseHypothesis& a, const PoseHypothesis& b) { return a.weight > b.weight; });
  hypotheses.resize(std::min(hypotheses.size(), options_.max_hypotheses));
  return hypotheses;
}

std::optional<double> LatticeTracker::PElsewhere() const {
  if (!last_) {
    return std::nullopt;
  }
  double p_elsewhere = 1.0;
  weights_.Best(&p_elsewhere);
  return p_elsewhere;
}

std::optional<PosePrior> LatticeTracker::Prior(const Pose2& motion, double sigmas) const {
  if (!last_ || !motion_known_) {
    return std::nullopt;
  }
  Motion moved = motion_;
  moved.Add(motion);
  const double radius_m = sigmas * PositionSigma(moved);
  if (radius_m > options_.max_motion_share * Period()) {
    return std::nullopt;
  }
  double p_elsewhere = 1.0;
  const Eigen::Vector2i best = weights_.Best(&p_elsewhere);
  const double changed = options_.slip_per_m * moved.path_m + options_.kidnap_per_frame;
  return PosePrior{PoseAt(best) * moved.last_from_now, radius_m, sigmas * YawSigma(moved),
                   std::min(1.0, p_elsewhere + changed)};
}

}  // namespace floorloc
