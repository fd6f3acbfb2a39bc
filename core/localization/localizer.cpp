// SPDX-License-Identifier: Apache-2.0
#include "core/localization/localizer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "core/localization/oriented_matches.h"
#include "core/localization/pose_decision.h"
#include "core/localization/pose_verifier.h"
#include "core/registration/least_squares.h"
#include "core/vision/feature_extractor.h"
#include "core/vision/guided_matcher.h"

namespace floorloc {
namespace {

constexpr double kGridCellPx = 70.0;

// Spread of a keypoint's own angle between two views.
constexpr double kKeypointAngleNoiseRad = 0.35;

// With a prior, every third keypoint usually finds the pose (all of them verify it); all look when it does not.
constexpr int kSparseStride = 3;
constexpr int kFullStride = 1;

// Floors repeat themselves more than independent points would: what looks like a chance of p happens with p^this.
constexpr double kStructureExponent = 0.5;

// Arm at which the systematic errors of position and heading weigh the same.
constexpr double kSystematicLeverM = 0.25;

LocalizerOptions ScaledTo(LocalizerOptions options, double resolution_m) {
  options.registration = options.registration.ScaledTo(resolution_m);
  return options;
}

class Stopwatch {
 public:
  /// Milliseconds since construction or the last lap.
  double LapMs() {
    const auto now = std::chrono::steady_clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - start_).count();
    start_ = now;
    return ms;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

NotLocalizedReason ReasonOf(RegistrationStatus status) {
  switch (status) {
    case RegistrationStatus::kTooFewMatches:
      return NotLocalizedReason::kTooFewMatches;
    case RegistrationStatus::kTooFewInliers:
      return NotLocalizedReason::kTooFewInliers;
    case RegistrationStatus::kNotSignificant:
      return NotLocalizedReason::kNotSignificant;
    case RegistrationStatus::kRegistered:
    case RegistrationStatus::kAmbiguous:
      return NotLocalizedReason::kNone;
  }
  return NotLocalizedReason::kNone;
}

LocalizationStatus StatusOf(RegistrationStatus status) {
  switch (status) {
    case RegistrationStatus::kRegistered:
      return LocalizationStatus::kLocalized;
    case RegistrationStatus::kAmbiguous:
      return LocalizationStatus::kAmbiguous;
    default:
      return LocalizationStatus::kNotLocalized;
  }
}

// What is searched, and how hard.
struct SearchScope {
  std::optional<PosePrior> prior;
  std::optional<MatchGuide> guide;  // follows from the prior

  bool Contains(const Pose2& map_from_base) const {
    if (!prior) {
      return true;
    }
    const Pose2 off = prior->map_from_base.Between(map_from_base);
    return off.translation().norm() <= prior->radius_m && std::abs(off.yaw()) <= prior->yaw_radius_rad;
  }
};

// How far a keypoint can be from its predicted place when the pose is off by the prior's radii.
MatchGuide GuideOf(const PosePrior& prior, const RectM& roi) {
  const double lever = std::max(std::hypot(roi.x_min, roi.y_min), std::hypot(roi.x_max, roi.y_max));
  return {prior.map_from_base, prior.radius_m + prior.yaw_radius_rad * lever,
          prior.yaw_radius_rad + kKeypointAngleNoiseRad, kSparseStride};
}

}  // namespace

struct Localizer::Impl {
  Impl(FloorMap floor_map, const LocalizerOptions& o)
      : options(ScaledTo(o, floor_map.info.camera.floor.resolution_m)),
        map(std::move(floor_map)),
        extractor(CreateFeatureExtractor(map.info.extractor)),
        index(CreateDescriptorIndex(map.keypoints.descriptors, o.index)),
        guided(map.keypoints.keypoints, map.keypoints.descriptors, kGridCellPx * map.info.camera.floor.resolution_m),
        verifier(map.keypoints, guided, map.info.area_m2, options.registration) {}

  LocalizerOptions options;
  FloorMap map;
  std::unique_ptr<FeatureExtractor> extractor;
  std::unique_ptr<DescriptorIndex> index;
  GuidedMatcher guided;
  PoseVerifier verifier;

  float MaxRatio() const {
    return extractor->descriptor_type() == DescriptorType::kBinary ? options.max_ratio_binary : options.max_ratio_float;
  }

  // First look: distinctive matches. With a prior a part of the keypoints is enough.
  std::vector<OrientedMatch> FindMatches(const Features& features, const std::optional<MatchGuide>& guide) const {
    const std::vector<Match> matches =
        guide ? guided.FindNearest(features, *guide) : FindNearest(*index, features.descriptors);
    return ToOrientedMatches(FilterByRatio(matches, MaxRatio()), features.keypoints, map.keypoints.keypoints);
  }

  // Second look: all keypoints where each pose that the matches vote for predicts them. Poses that meet are one.
  std::vector<VerifiedPose> VerifyCandidates(const Features& features, const std::vector<OrientedMatch>& matches,
                                             const SearchScope& scope) const {
    const SearchRegion region = RegionOf(scope.guide);
    std::vector<VerifiedPose> verified;
    for (const PoseCandidate& candidate : FindPoseCandidates(matches, options.registration)) {
      VerifiedPose pose = verifier.Verify(features, candidate.target_from_source);
      const Pose2& refined = pose.candidate.target_from_source;
      const bool known = std::any_of(verified.begin(), verified.end(), [&](const VerifiedPose& v) {
        return SamePose(v.candidate.target_from_source, refined, options.registration);
      });
      if (!known && scope.Contains(refined)) {
        pose.votes = static_cast<int>(FindInliers(matches, refined, options.registration.inlier_radius_m).size());
        // Both looks must be beyond chance: on self-similar floors many keypoints fit a wrong place, but few are
        // distinctive there.
        const double log_chance_votes =
            LogChancePoses(static_cast<int>(matches.size()), pose.votes, region, options.registration);
        pose.candidate.log_false_alarms =
            std::max(pose.candidate.log_false_alarms, kStructureExponent * log_chance_votes);
        verified.push_back(std::move(pose));
      }
    }
    return verified;
  }

  SearchRegion RegionOf(const std::optional<MatchGuide>& guide) const {
    return {guide ? std::numbers::pi * guide->radius_m * guide->radius_m : std::max(map.info.area_m2, 0.01)};
  }

  // Matches, verifies and decides; adds its times to the result's.
  void Search(const Features& features, const SearchScope& scope, LocalizationResult* result) const {
    Stopwatch stage;
    const std::vector<OrientedMatch> matches = FindMatches(features, scope.guide);
    result->timing.match_ms += stage.LapMs();
    const std::vector<VerifiedPose> verified = VerifyCandidates(features, matches, scope);
    Conclude(verified, result);
    result->timing.register_ms += stage.LapMs();
  }

  void Conclude(const std::vector<VerifiedPose>& verified, LocalizationResult* result) const {
    PoseDecision decision = DecidePose(verified, verifier.max_distance(), options.registration);
    result->status = StatusOf(decision.status);
    result->reason = ReasonOf(decision.status);
    result->p_wrong = decision.p_wrong;
    result->alternatives = std::move(decision.alternatives);
    if (decision.best < 0) {
      return;
    }
    const VerifiedPose& best = verified[static_cast<std::size_t>(decision.best)];
    const Pose2& pose = best.candidate.target_from_source;
    result->map_from_base = pose;
    result->matches = static_cast<int>(best.matches.size());
    result->inliers = static_cast<int>(best.candidate.inliers.size());
    result->rms_m = RmsResidual(best.matches, best.candidate.inliers, pose);
    const double noise_m = KeypointNoise(result->rms_m, result->inliers, options.registration);
    result->covariance = PoseCovariance(best.matches, best.candidate.inliers, pose, noise_m);
  }

  // What keypoints alone do not show: errors of map and mounting, which turn and shift the region of interest as a
  // whole about its middle.
  void AddSystematicErrors(const Eigen::Vector2d& roi_center, LocalizationResult* result) const {
    const Eigen::Vector2d arm = -(result->map_from_base.rotation() * roi_center);
    Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity();
    jacobian(0, 2) = -arm.y();
    jacobian(1, 2) = arm.x();
    const double t = std::hypot(options.systematic_m, options.systematic_share * result->rms_m);
    const double r = t / kSystematicLeverM;
    const Eigen::Vector3d variance(t * t, t * t, r * r);
    result->covariance += jacobian * variance.asDiagonal() * jacobian.transpose();
  }
};

void LocalizerOptions::Check() const {
  if (!(max_ratio_float > 0.0F && max_ratio_float <= 1.0F) || !(max_ratio_binary > 0.0F && max_ratio_binary <= 1.0F)) {
    throw std::invalid_argument("max_ratio must be above 0 and at most 1");
  }
  if (index.trees < 1 || index.trees > 64 || index.checks < 1 || index.checks > 1000000) {
    throw std::invalid_argument("index trees must be 1 to 64 and checks 1 to 1000000");
  }
  registration.Check();
}

const char* ToString(LocalizationStatus status) {
  switch (status) {
    case LocalizationStatus::kLocalized:
      return "localized";
    case LocalizationStatus::kAmbiguous:
      return "ambiguous";
    case LocalizationStatus::kNotLocalized:
      return "not_localized";
  }
  return "unknown";
}

const char* ToString(NotLocalizedReason reason) {
  switch (reason) {
    case NotLocalizedReason::kNone:
      return "";
    case NotLocalizedReason::kTooFewKeypoints:
      return "too_few_keypoints";
    case NotLocalizedReason::kTooFewMatches:
      return "too_few_matches";
    case NotLocalizedReason::kTooFewInliers:
      return "too_few_inliers";
    case NotLocalizedReason::kNotSignificant:
      return "not_significant";
  }
  return "unknown";
}

Localizer::Localizer(FloorMap map, const LocalizerOptions& options) {
  options.Check();
  impl_ = std::make_unique<Impl>(std::move(map), options);
}

Localizer::~Localizer() = default;

const FloorMap& Localizer::map() const { return impl_->map; }

LocalizationResult Localizer::Localize(const Rectifier& rectifier, const cv::Mat& raw,
                                       const std::optional<PosePrior>& prior) const {
  LocalizationResult result;
  result.used_prior = prior.has_value();
  Stopwatch total;
  Stopwatch stage;
  const GroundImage image = rectifier.Rectify(raw);
  result.timing.rectify_ms = stage.LapMs();

  const Features features = impl_->extractor->Extract(image);
  result.timing.features_ms = stage.LapMs();
  result.keypoints = static_cast<int>(features.keypoints.size());
  if (result.keypoints < impl_->options.registration.min_inliers) {
    result.reason = NotLocalizedReason::kTooFewKeypoints;
    result.timing.total_ms = total.LapMs();
    return result;
  }

  SearchScope scope{prior, std::nullopt};
  if (prior) {
    scope.guide = GuideOf(*prior, rectifier.camera().floor.roi);
  }
  impl_->Search(features, scope, &result);
  if (prior && result.status != LocalizationStatus::kLocalized) {
    scope.guide->stride = kFullStride;
    impl_->Search(features, scope, &result);
  }
  impl_->AddSystematicErrors(rectifier.camera().floor.roi.Center(), &result);
  result.timing.total_ms = total.LapMs();
  return result;
}

}  // namespace floorloc
