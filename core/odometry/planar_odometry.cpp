// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/planar_odometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

// First search radius about the prediction: this many pixels plus a share of the motion.
constexpr double kNearPx = 20.0;
constexpr double kNearRad = 0.1;
constexpr double kMotionShare = 0.3;

// Factor of the second search radius.
constexpr double kWideningFactor = 4.0;

// Tolerance of the speed limits: time stamps are not exact.
constexpr double kSlackM = 0.03;
constexpr double kSlackRad = 0.1;

// Relative error of a guess: wheels slip.
constexpr double kGuessShare = 0.5;

TrackingLoss ToTrackingLoss(RegistrationStatus status) {
  switch (status) {
    case RegistrationStatus::kRegistered:
      return TrackingLoss::kNone;
    case RegistrationStatus::kAmbiguous:
      return TrackingLoss::kAmbiguous;
    case RegistrationStatus::kTooFewMatches:
      return TrackingLoss::kTooFewMatches;
    case RegistrationStatus::kTooFewInliers:
      return TrackingLoss::kTooFewInliers;
    case RegistrationStatus::kNotSignificant:
    case RegistrationStatus::kViewDisagrees:
      return TrackingLoss::kNotSignificant;
  }
  return TrackingLoss::kNone;
}

double Seconds(std::int64_t from_ns, std::int64_t to_ns) {
  return (static_cast<double>(to_ns) - static_cast<double>(from_ns)) * 1e-9;
}

// A frame that others may be registered to, with its pose.
struct Anchor {
  FloorView view;
  Pose2 odom_from_base;
};

// The newest frame whose pose is known, relative to the keyframe.
struct TrackedFrame {
  std::int64_t stamp_ns = 0;
  AnchoredPose pose;         ///< with the covariance of the registration
  AnchoredPose accumulated;  ///< with the sum of the incremental covariances since the keyframe
};

// An anchor to register to, and the frame from which the motion then starts.
struct SearchTarget {
  std::unique_ptr<Anchor>* anchor;
  TrackedFrame from;
};

// Predicted pose of the next frame.
struct Prediction {
  Pose2 odom_from_base;
  Pose2 step;                      ///< predicted motion since the last tracked frame
  double search_radius_m = 0.0;    ///< largest distance from the prediction
  double search_radius_rad = 0.0;  ///< the same for the heading
};

ViewRegistrationOptions RegistrationOf(const PlanarOdometryOptions& o) {
  return {.registration = o.registration.ScaledTo(o.resolution_m),
          .resolution_m = o.resolution_m,
          .max_ratio_binary = o.max_ratio_binary,
          .max_ratio_float = o.max_ratio_float,
          .systematic_m = o.systematic_m,
          .systematic_rad = o.systematic_rad,
          .min_inlier_share = o.min_inlier_share};
}

}  // namespace

const char* ToString(PlanarOdometryStatus status) {
  switch (status) {
    case PlanarOdometryStatus::kFirstFrame:
      return "first_frame";
    case PlanarOdometryStatus::kTracked:
      return "tracked";
    case PlanarOdometryStatus::kLost:
      return "lost";
  }
  return "unknown";
}

const char* ToString(TrackingLoss loss) {
  switch (loss) {
    case TrackingLoss::kNone:
      return "none";
    case TrackingLoss::kTooFewKeypoints:
      return "too_few_keypoints";
    case TrackingLoss::kTooFewMatches:
      return "too_few_matches";
    case TrackingLoss::kTooFewInliers:
      return "too_few_inliers";
    case TrackingLoss::kNotSignificant:
      return "not_significant";
    case TrackingLoss::kAmbiguous:
      return "ambiguous";
    case TrackingLoss::kTooFast:
      return "too_fast";
    case TrackingLoss::kContradictsGuess:
      return "contradicts_guess";
  }
  return "unknown";
}

RegistrationOptions PlanarOdometryOptions::DefaultRegistration() {
  RegistrationOptions registration;
  registration.min_inliers = 12;
  registration.max_p_wrong = 1e-5;
  return registration;
}

void PlanarOdometryOptions::Check() const {
  registration.Check();
  RequireOption(resolution_m > 0 && resolution_m < 1, "resolution_m must be between 0 and 1 m");
  RequireOption(max_ratio_binary > 0 && max_ratio_binary <= 1, "max_ratio_binary must be above 0 and at most 1");
  RequireOption(max_ratio_float > 0 && max_ratio_float <= 1, "max_ratio_float must be above 0 and at most 1");
  RequireOption(systematic_m >= 0 && systematic_m < 1, "systematic_m must be 0 to 1 m");
  RequireOption(systematic_rad >= 0 && systematic_rad < 1, "systematic_rad must be 0 to 1 rad");
  RequireOption(min_inlier_share >= 0 && min_inlier_share < 1, "min_inlier_share must be at least 0 and below 1");
  RequireOption(min_overlap >= 0 && min_overlap <= 1, "min_overlap must be 0 to 1");
  RequireOption(max_speed_m_s > 0 && max_speed_m_s < 1e3, "max_speed_m_s must be between 0 and 1000 m/s");
  RequireOption(max_yaw_rate_rad_s > 0 && max_yaw_rate_rad_s < 1e3,
                "max_yaw_rate_rad_s must be between 0 and 1000 rad/s");
  RequireOption(max_guess_error_m > 0, "max_guess_error_m must be positive");
  RequireOption(max_guess_error_rad > 0, "max_guess_error_rad must be positive");
}

struct PlanarOdometry::State {
  explicit State(const PlanarOdometryOptions& o) : options(o), registration(RegistrationOf(o)) {}

  PlanarOdometryOptions options;
  ViewRegistrationOptions registration;
  std::unique_ptr<Anchor> keyframe;
  std::unique_ptr<Anchor> last;  // last tracked frame after the keyframe
  std::unique_ptr<Anchor> lost;  // newest lost frame
  TrackedFrame tracked;          // relative to the keyframe
  Eigen::Vector3d twist_per_s = Eigen::Vector3d::Zero();
  std::optional<std::int64_t> newest_ns;
  Pose2 newest_odom_from_base;  // of the newest frame, tracked or not
  int chain = 0;

  std::unique_ptr<Anchor> MakeAnchor(std::int64_t stamp_ns, const Features& features, const Pose2& pose) const {
    return std::make_unique<Anchor>(Anchor{FloorView(stamp_ns, features, options.resolution_m), pose});
  }

  Prediction Predict(std::int64_t stamp_ns, const std::optional<Pose2>& guess) const {
    const double since_newest_s = Seconds(*newest_ns, stamp_ns);
    const Pose2 step = guess ? *guess : Pose2::Exp(twist_per_s * since_newest_s);
    const double unknown_s = Seconds(tracked.stamp_ns, stamp_ns);
    Prediction prediction;
    prediction.odom_from_base = newest_odom_from_base * step;
    prediction.step = step;
    prediction.search_radius_m = step.translation().norm() + options.max_speed_m_s * unknown_s + kSlackM;
    prediction.search_radius_rad = std::abs(step.yaw()) + options.max_yaw_rate_rad_s * unknown_s + kSlackRad;
    return prediction;
  }

  // Searches near the prediction, then in a wider radius, then within the speed limits.
  ViewRegistration Search(const Anchor& anchor, const Features& features, const Prediction& prediction) const {
    const Pose2 expected = anchor.odom_from_base.Between(prediction.odom_from_base);
    const double near_m = kNearPx * options.resolution_m + kMotionShare * prediction.step.translation().norm();
    const double near_rad = kNearRad + kMotionShare * std::abs(prediction.step.yaw());
    ViewRegistration found;
    for (const auto& [radius_m, yaw_rad] :
         {std::pair(near_m, near_rad), std::pair(kWideningFactor * near_m, kWideningFactor * near_rad),
          std::pair(prediction.search_radius_m, prediction.search_radius_rad)}) {
      const ViewGuess guess{expected, radius_m, std::min(yaw_rad + kKeypointAngleNoiseRad, std::numbers::pi)};
      found = anchor.view.Register(features, guess, registration);
      if (found.ok() || (radius_m >= prediction.search_radius_m && yaw_rad >= prediction.search_radius_rad)) {
        break;
      }
    }
    return found;
  }

  // Rejects motions beyond the speed limits or far from the guess, however good the fit.
  TrackingLoss CheckPlausible(const VisualMotion& motion, const std::optional<Pose2>& guess) const {
    const double seconds = Seconds(motion.from_ns, motion.to_ns);
    const Pose2& step = motion.from_from_to;
    if (step.translation().norm() > options.max_speed_m_s * seconds + kSlackM ||
        std::abs(step.yaw()) > std::min(options.max_yaw_rate_rad_s * seconds + kSlackRad, std::numbers::pi)) {
      return TrackingLoss::kTooFast;
    }
    if (guess && motion.from_ns == newest_ns) {
      const Pose2 error = guess->Between(step);
      if (error.translation().norm() > options.max_guess_error_m + kGuessShare * guess->translation().norm() ||
          std::abs(error.yaw()) > options.max_guess_error_rad + kGuessShare * std::abs(guess->yaw())) {
        return TrackingLoss::kContradictsGuess;
      }
    }
    return TrackingLoss::kNone;
  }

  PlanarOdometryResult Start(std::int64_t stamp_ns, const Features& features) {
    keyframe = MakeAnchor(stamp_ns, features, newest_odom_from_base);
    tracked = {stamp_ns, {}, {}};
    newest_ns = stamp_ns;
    PlanarOdometryResult result;
    result.odom_from_base = newest_odom_from_base;
    result.new_keyframe = true;
    return result;
  }

  // The anchors to register to, in this order.
  std::vector<SearchTarget> SearchTargets() {
    std::vector<SearchTarget> targets = {{&keyframe, tracked}};
    for (std::unique_ptr<Anchor>* anchor : {&last, &lost}) {
      if (*anchor) {
        targets.push_back({anchor, {(*anchor)->view.stamp_ns(), {}, {}}});
      }
    }
    return targets;
  }

  PlanarOdometryResult TrackFrame(std::int64_t stamp_ns, const Features& features, const std::optional<Pose2>& guess) {
    const Prediction prediction = Predict(stamp_ns, guess);
    TrackingLoss loss = TrackingLoss::kNone;
    for (const SearchTarget& target : SearchTargets()) {
      const ViewRegistration found = Search(**target.anchor, features, prediction);
      TrackingLoss failure = ToTrackingLoss(found.status);
      if (found.ok()) {
        const VisualMotion motion = MotionOf(target.from, stamp_ns, found);
        failure = CheckPlausible(motion, guess);
        if (failure == TrackingLoss::kNone) {
          PromoteToKeyframe(target.anchor);
          return Accept(motion, found, features);
        }
      }
      loss = loss == TrackingLoss::kNone ? failure : loss;
    }
    return HandleLost(stamp_ns, features, loss, guess);
  }

  static VisualMotion MotionOf(const TrackedFrame& from, std::int64_t stamp_ns, const ViewRegistration& found) {
    const AnchoredPose to{found.view_from_base, found.covariance};
    VisualMotion motion;
    motion.from_ns = from.stamp_ns;
    motion.to_ns = stamp_ns;
    motion.from_from_to = from.pose.anchor_from_base.Between(to.anchor_from_base);
    motion.covariance = IncrementalCovariance(from.accumulated, to);
    motion.covariance_alone = MotionCovariance(from.pose, to);
    motion.matches = found.matches;
    motion.inliers = found.inliers;
    motion.rms_m = found.rms_m;
    motion.overlap = found.overlap;
    return motion;
  }

  // The anchor that a frame was registered to becomes the keyframe.
  void PromoteToKeyframe(std::unique_ptr<Anchor>* anchor) {
    if (anchor != &keyframe) {
      chain += anchor == &lost ? 1 : 0;
      SetKeyframe(std::move(*anchor));
    }
  }

  void SetKeyframe(std::unique_ptr<Anchor> anchor) {
    tracked = {anchor->view.stamp_ns(), {}, {}};
    keyframe = std::move(anchor);
    last.reset();
  }

  PlanarOdometryResult Accept(const VisualMotion& motion, const ViewRegistration& found, const Features& features) {
    tracked.accumulated.covariance = PropagatedCovariance(tracked.accumulated, motion.from_from_to, motion.covariance);
    tracked.accumulated.anchor_from_base = found.view_from_base;
    tracked.pose = {found.view_from_base, found.covariance};
    tracked.stamp_ns = motion.to_ns;
    twist_per_s = motion.from_from_to.Log() / Seconds(motion.from_ns, motion.to_ns);
    newest_ns = motion.to_ns;
    newest_odom_from_base = keyframe->odom_from_base * found.view_from_base;
    lost.reset();
    PlanarOdometryResult result;
    result.status = PlanarOdometryStatus::kTracked;
    result.chain = chain;
    result.motion = motion;
    result.odom_from_base = newest_odom_from_base;
    last = MakeAnchor(motion.to_ns, features, newest_odom_from_base);
    result.new_keyframe = found.overlap < options.min_overlap;
    if (result.new_keyframe) {
      SetKeyframe(std::move(last));
    }
    return result;
  }

  // Propagates the pose by the guess; keeps it without one.
  PlanarOdometryResult HandleLost(std::int64_t stamp_ns, const Features& features, TrackingLoss loss,
                                  const std::optional<Pose2>& guess) {
    twist_per_s.setZero();
    newest_odom_from_base = guess ? newest_odom_from_base * *guess : newest_odom_from_base;
    newest_ns = stamp_ns;
    if (loss != TrackingLoss::kTooFewKeypoints) {
      lost = MakeAnchor(stamp_ns, features, newest_odom_from_base);
    }
    PlanarOdometryResult result;
    result.status = PlanarOdometryStatus::kLost;
    result.loss = loss;
    result.chain = chain;
    result.odom_from_base = newest_odom_from_base;
    return result;
  }
};

PlanarOdometry::PlanarOdometry(const PlanarOdometryOptions& options) {
  options.Check();
  state_ = std::make_unique<State>(options);
}

PlanarOdometry::~PlanarOdometry() = default;
PlanarOdometry::PlanarOdometry(PlanarOdometry&&) noexcept = default;
PlanarOdometry& PlanarOdometry::operator=(PlanarOdometry&&) noexcept = default;

void PlanarOdometry::Reset() { state_ = std::make_unique<State>(state_->options); }

PlanarOdometryResult PlanarOdometry::Track(std::int64_t stamp_ns, const Features& features,
                                           const std::optional<Pose2>& guess) {
  if (state_->newest_ns && stamp_ns <= *state_->newest_ns) {
    throw std::invalid_argument("the time stamp " + std::to_string(stamp_ns) +
                                " ns is not after the previous frame's, " + std::to_string(*state_->newest_ns) +
                                " ns; give frames in order of time, or reset the odometry");
  }
  if (guess && !guess->IsFinite()) {
    throw std::invalid_argument("the guess of the motion since the previous frame is not finite; leave it out");
  }
  if (static_cast<int>(features.keypoints.size()) < state_->options.registration.min_inliers) {
    return state_->HandleLost(stamp_ns, features, TrackingLoss::kTooFewKeypoints, guess);
  }
  return state_->keyframe ? state_->TrackFrame(stamp_ns, features, guess) : state_->Start(stamp_ns, features);
}

}  // namespace floorloc
