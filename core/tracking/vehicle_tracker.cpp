// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/vehicle_tracker.h"

#include <algorithm>
#include <cmath>

#include "core/fusion/filter_state.h"
#include "core/geometry/option_check.h"
#include "core/tracking/mask_learner.h"

namespace floorloc {
namespace {

// Odometry that ends this long before an image still counts as covering it.
constexpr std::int64_t kOdometryLagNs = 30'000'000;

PlanarOdometryOptions VisualOptions(double resolution_m) {
  PlanarOdometryOptions options;
  options.resolution_m = resolution_m;
  return options;
}

struct Sigmas {
  double position_m = 0.0;
  double yaw_rad = 0.0;
};

Sigmas SigmasOf(const FusedPose& pose) {
  return {LargestSigma(pose.covariance.topLeftCorner<2, 2>()), std::sqrt(pose.covariance(2, 2))};
}

ViewPose PoseOf(std::int64_t stamp_ns, const FrameOutcome& outcome, const LocalizationResult& found) {
  ViewPose pose;
  pose.stamp_ns = stamp_ns;
  if (outcome.fix && outcome.fix->accepted) {
    pose.map_from_base = found.map_from_base;
  }
  if (outcome.visual_used && outcome.visual.status != PlanarOdometryStatus::kLost) {
    pose.odom_from_base = outcome.visual.odom_from_base;
    pose.chain = outcome.visual.chain;
  }
  return pose;
}

}  // namespace

void PriorOptions::Check() const {
  RequireOption(sigmas > 0.0, "sigmas must be positive");
  RequireOption(min_radius_m > 0.0, "min_radius_m must be positive");
  RequireOption(max_radius_m >= min_radius_m, "max_radius_m must be at least min_radius_m");
  RequireOption(min_yaw_radius_rad > 0.0, "min_yaw_radius_rad must be positive");
  RequireOption(max_yaw_radius_rad >= min_yaw_radius_rad, "max_yaw_radius_rad must be at least min_yaw_radius_rad");
}

void NextFrameOptions::Check() const {
  RequireOption(max_s > 0.0, "max_s must be positive");
  RequireOption(max_m > 0.0, "max_m must be positive");
}

void TrackerOptions::Check() const {
  filter.Check();
  prior.Check();
  next.Check();
  camera.Check();
  mask.Check();
  readout.Check();
  lattice.Check();
  twist.Check();
  RequireOption(max_odometry_lag_s >= 0 && max_odometry_lag_s <= 10, "max_odometry_lag_s must be 0 to 10");
}

struct VehicleTracker::State {
  State(const TrackerOptions& o, double resolution_m_in)
      : options(o),
        resolution_m(resolution_m_in),
        fuser(MakePoseFuser(o.method, o.filter)),
        visual(VisualOptions(resolution_m_in)),
        camera(o.camera),
        mask(o.mask),
        readout(o.readout),
        lattice(o.lattice) {}

  TrackerOptions options;
  double resolution_m;
  std::unique_ptr<PoseFuser> fuser;
  PlanarOdometry visual;
  CameraEstimator camera;
  MaskLearner mask;
  ReadoutEstimator readout;
  LatticeTracker lattice;
  std::optional<std::int64_t> lattice_ns;  // to which its places were moved
  std::optional<std::int64_t> last_frame_ns;
  std::optional<MotionIncrement> last_wheels;
  std::optional<std::int64_t> odometry_until_ns;

  // Motion since the last frame by wheel odometry, which may end a little before: the vehicle keeps its velocity.
  std::optional<Pose2> OdometrySinceLastFrame(std::int64_t stamp_ns) const {
    const std::int64_t lag_ns = std::llround(1e9 * options.max_odometry_lag_s);
    if (!last_frame_ns || !odometry_until_ns || *odometry_until_ns + lag_ns < stamp_ns) {
      return std::nullopt;
    }
    return fuser->MotionBetween(*last_frame_ns, stamp_ns);
  }

  // A read-out that was measured with reversed wheels has the wrong sign.
  bool WheelsAgree() const {
    const std::optional<FusedPose> now = fuser->Estimate();
    return !now || !now->odometry || now->odometry->health == OdometryHealth::kOk;
  }

  std::optional<Eigen::Vector3d> TwistAt(std::int64_t stamp_ns) const {
    LastMotion last{last_frame_ns, last_wheels};
    if (odometry_until_ns) {
      last.until_ns = std::max(*odometry_until_ns, last_frame_ns.value_or(*odometry_until_ns));
    }
    return TwistAtFrame(*fuser, last, stamp_ns, options.twist);
  }

  void UpdateVisualOdometry(std::int64_t stamp_ns, const Features& features, FrameOutcome* outcome) {
    if (!options.visual_odometry || (last_frame_ns && stamp_ns <= *last_frame_ns)) {
      return;
    }
    outcome->visual = visual.Track(stamp_ns, features, OdometrySinceLastFrame(stamp_ns));
    outcome->visual_used = true;
    last_frame_ns = stamp_ns;
    if (const auto& motion = outcome->visual.motion) {
      fuser->AddIncrement(MotionSource::kVision,
                          {motion->from_ns, motion->to_ns, motion->from_from_to, motion->covariance});
    }
  }

  void LearnMask(const ViewPose& now, const GroundImage& floor) {
    mask.Add(now, floor, [&](std::int64_t from_ns, std::int64_t to_ns) {
      const bool covered = odometry_until_ns && *odometry_until_ns + kOdometryLagNs >= to_ns;
      return covered ? fuser->MotionBetween(from_ns, to_ns) : std::nullopt;
    });
  }

  // Motion of the base since the places of the lattice were moved, by wheels that cover it.
  std::optional<Pose2> MotionOfPlaces(std::int64_t stamp_ns) const {
    const bool covered = odometry_until_ns && *odometry_until_ns + kOdometryLagNs >= stamp_ns;
    return covered && lattice_ns ? fuser->MotionBetween(*lattice_ns, stamp_ns) : std::nullopt;
  }

  void MovePlaces(std::int64_t stamp_ns, const PlanarOdometryResult& tracked) {
    if (lattice_ns && *lattice_ns < stamp_ns) {
      const bool seen = tracked.motion && tracked.motion->to_ns == stamp_ns && tracked.motion->from_ns <= *lattice_ns;
      const auto motion = seen ? fuser->MotionBetween(*lattice_ns, stamp_ns) : MotionOfPlaces(stamp_ns);
      motion ? lattice.Move(*motion) : lattice.LoseMotion();
    }
    lattice_ns = std::max(lattice_ns.value_or(stamp_ns), stamp_ns);
  }

  // What the frame says of the vehicle's place, alone or together with earlier ones.
  std::optional<PoseFix> FixOf(std::int64_t stamp_ns, const LocalizationResult& found, FrameOutcome* outcome) {
    const bool localized = found.status == LocalizationStatus::kLocalized;
    if (found.lattice && lattice_ns == stamp_ns && !(localized && !found.lattice->by_prior)) {
      outcome->by_drive = lattice.Add(*found.lattice);
      return outcome->by_drive ? std::optional(PoseFix{stamp_ns, outcome->by_drive->map_from_base,
                                                       found.lattice->covariance, outcome->by_drive->p_wrong})
                               : std::nullopt;
    }
    if (!localized) {
      return std::nullopt;
    }
    if (found.lattice && lattice_ns == stamp_ns) {
      lattice.AddLocalized(*found.lattice, found.map_from_base, found.p_wrong);
    }
    return PoseFix{stamp_ns, found.map_from_base, found.covariance, found.p_wrong};
  }

  void ApplyFix(std::int64_t stamp_ns, const LocalizationResult& found, FrameOutcome* outcome) {
    const std::optional<PoseFix> fix = FixOf(stamp_ns, found, outcome);
    if (!fix) {
      fuser->AddUnlocalizedFrame(stamp_ns);
      return;
    }
    outcome->fix = fuser->AddFix(*fix);
    const bool alone = outcome->fix->accepted && found.status == LocalizationStatus::kLocalized;
    if (alone && found.camera) {
      camera.Add(*found.camera, found.map_from_base, found.p_wrong);
    }
    if (alone && found.readout && WheelsAgree()) {
      readout.Add(*found.readout);
    }
  }

  // Where the vehicle probably is, of the places that it may be at.
  std::optional<PosePrior> LikeliestPlace(std::int64_t stamp_ns) const {
    const std::optional<Pose2> motion = MotionOfPlaces(stamp_ns);
    return motion ? lattice.Prior(*motion, options.prior.sigmas) : std::nullopt;
  }

  // The risk of a prior that holds one place of the lattice only, which is where the drive tells that the vehicle is.
  std::optional<double> PElsewhere(const PosePrior& prior, std::int64_t stamp_ns) const {
    const double reach_m = options.lattice.max_motion_share * lattice.Period();
    const std::optional<PosePrior> place = prior.radius_m <= reach_m ? LikeliestPlace(stamp_ns) : std::nullopt;
    if (!place || *place->p_elsewhere > options.lattice.max_p_wrong) {
      return std::nullopt;
    }
    const Pose2 apart = prior.map_from_base.Between(place->map_from_base);
    return apart.translation().norm() <= reach_m && std::abs(apart.yaw()) <= prior.yaw_radius_rad ? place->p_elsewhere
                                                                                                  : std::nullopt;
  }
};

VehicleTracker::VehicleTracker(const TrackerOptions& options, double resolution_m)
    : state_((options.Check(), std::make_unique<State>(options, resolution_m))) {}
VehicleTracker::~VehicleTracker() = default;
VehicleTracker::VehicleTracker(VehicleTracker&&) noexcept = default;
VehicleTracker& VehicleTracker::operator=(VehicleTracker&&) noexcept = default;

MessageOutcome VehicleTracker::AddOdometry(const MotionIncrement& increment) {
  const MessageOutcome outcome = state_->fuser->AddIncrement(MotionSource::kWheels, increment);
  if (outcome == MessageOutcome::kClockJump) {
    state_->visual.Reset();
    state_->mask.ForgetReference();
    state_->lattice.LoseMotion();
    state_->lattice_ns.reset();
    state_->last_frame_ns.reset();
    state_->odometry_until_ns.reset();
    state_->last_wheels.reset();
  }
  if (outcome == MessageOutcome::kUsed || outcome == MessageOutcome::kClockJump) {
    state_->odometry_until_ns = std::max(state_->odometry_until_ns.value_or(increment.to_ns), increment.to_ns);
    state_->last_wheels = increment;
  }
  return outcome;
}

MessageOutcome VehicleTracker::AddImu(const ImuReading& reading) { return state_->fuser->AddImu(reading); }

std::optional<CameraPrior> VehicleTracker::PriorOfCamera() const { return state_->camera.PriorOfNextFrame(); }

CameraEstimate VehicleTracker::Camera() const {
  CameraEstimate estimate = state_->camera.Estimate();
  estimate.readout = state_->readout.Estimate();
  return estimate;
}

FrameMotion VehicleTracker::Motion(std::int64_t stamp_ns) const {
  return {state_->TwistAt(stamp_ns), state_->readout.Estimate()};
}

void VehicleTracker::Restart() {
  const LearntValues learnt = Learnt();
  state_ = std::make_unique<State>(state_->options, state_->resolution_m);
  Resume(learnt);
}

LearntValues VehicleTracker::Learnt() const {
  return {state_->fuser->Learnt(), state_->camera.Learnt(), state_->readout.Learnt(), state_->mask.Learnt()};
}

void VehicleTracker::Resume(const LearntValues& learnt) {
  state_->camera.Resume(learnt.camera);
  state_->readout.Resume(learnt.readout);
  state_->mask.Resume(learnt.mask);
  if (learnt.odometry) {
    state_->fuser->Resume(*learnt.odometry);
  }
}

const LearnedMaskState& VehicleTracker::Mask() const { return state_->mask.State(); }

void VehicleTracker::SetPose(const PoseFix& pose) { state_->fuser->SetPose(pose); }

std::optional<PosePrior> VehicleTracker::Prior(std::int64_t stamp_ns) const {
  const PriorOptions& o = state_->options.prior;
  const std::optional<FusedPose> expected = state_->fuser->EstimateAt(stamp_ns);
  if (!expected || expected->state == TrackingState::kLost || expected->contradicted) {
    return state_->LikeliestPlace(stamp_ns);
  }
  const Sigmas sigmas = SigmasOf(*expected);
  if (o.sigmas * sigmas.position_m > o.max_radius_m || o.sigmas * sigmas.yaw_rad > o.max_yaw_radius_rad) {
    return state_->LikeliestPlace(stamp_ns);
  }
  PosePrior prior{expected->map_from_base, std::max(o.min_radius_m, o.sigmas * sigmas.position_m),
                  std::max(o.min_yaw_radius_rad, o.sigmas * sigmas.yaw_rad)};
  prior.p_elsewhere = state_->PElsewhere(prior, stamp_ns);
  return prior;
}

FrameOutcome VehicleTracker::AddFrame(std::int64_t stamp_ns, const Features& features,
                                      const LocalizationResult& found) {
  FrameOutcome outcome;
  state_->UpdateVisualOdometry(stamp_ns, features, &outcome);
  state_->MovePlaces(stamp_ns, outcome.visual);
  state_->ApplyFix(stamp_ns, found, &outcome);
  return outcome;
}

FrameOutcome VehicleTracker::AddFrame(std::int64_t stamp_ns, const Features& features, const GroundImage& floor,
                                      const LocalizationResult& found) {
  FrameOutcome outcome = AddFrame(stamp_ns, features, found);
  state_->LearnMask(PoseOf(stamp_ns, outcome, found), floor);
  return outcome;
}

std::optional<FusedPose> VehicleTracker::Estimate() const { return state_->fuser->Estimate(); }

std::optional<FusedPose> VehicleTracker::EstimateAt(std::int64_t stamp_ns) const {
  return state_->fuser->EstimateAt(stamp_ns);
}

std::vector<PoseHypothesis> VehicleTracker::Alternatives() const {
  const std::optional<double> p_elsewhere = state_->lattice.PElsewhere();
  return p_elsewhere && *p_elsewhere > state_->options.lattice.max_p_wrong ? state_->lattice.Hypotheses()
                                                                           : std::vector<PoseHypothesis>();
}

// The distance until odometry alone is worse than "localized", and short enough to notice a kidnapping.
NextFrame VehicleTracker::Next() const {
  const std::optional<FusedPose> now = Estimate();
  const bool without_wheels = now && now->odometry && now->odometry->health == OdometryHealth::kRejected;
  if (!now || now->state != TrackingState::kLocalized || without_wheels) {
    return {};
  }
  const NextFrameOptions& o = state_->options.next;
  const FilterLimits& limits = state_->options.filter.limits;
  const OdometryNoise& noise = state_->options.filter.odometry;
  const Sigmas sigmas = SigmasOf(*now);
  const double margin_m2 = limits.localized_m * limits.localized_m - sigmas.position_m * sigmas.position_m;
  const double margin_rad2 = limits.localized_rad * limits.localized_rad - sigmas.yaw_rad * sigmas.yaw_rad;
  const double metres =
      std::min(margin_m2 / (noise.noise_m * noise.noise_m), margin_rad2 / (noise.noise_rad * noise.noise_rad)) /
      now->wheel_noise_factor;
  const double since_s = now->since_fix ? now->since_fix->seconds : 0.0;
  const double since_m = now->since_fix ? now->since_fix->metres : 0.0;
  return {std::max(0.0, o.max_s - since_s), std::clamp(o.max_m - since_m, 0.0, std::max(0.0, metres))};
}

}  // namespace floorloc
