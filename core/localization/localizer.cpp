// SPDX-License-Identifier: Apache-2.0
#include "core/localization/localizer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "core/localization/oriented_matches.h"
#include "core/localization/photometric_aligner.h"
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

// Above this risk of being wrong the keypoints alone do not decide: all poses are laid over the mosaic.
constexpr double kClearPWrong = 1e-6;

// A frame whose picture agrees less with the mosaic keeps the pose that its keypoints gave it.
constexpr double kMinCorrelation = 0.15;

// Pictures may correct where keypoints put the middle of the frame by this, in inlier radii.
constexpr double kMaxCorrection = 2.0;

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

// A frame, as the stages need it.
struct FrameView {
  Features features;
  FrameSamples samples;
  Eigen::Vector3d camera_center;
};

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

// What a frame alone does not show: errors of the map, which turn and shift the floor in view as a whole about its
// middle.
Eigen::Matrix3d SystematicCovariance(const Pose2& map_from_base, const Eigen::Vector2d& view_center, double error_m) {
  const Eigen::Vector2d arm = -(map_from_base.rotation() * view_center);
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity();
  jacobian(0, 2) = -arm.y();
  jacobian(1, 2) = arm.x();
  const double turn = error_m / kSystematicLeverM;
  const Eigen::Vector3d variance(error_m * error_m, error_m * error_m, turn * turn);
  return jacobian * variance.asDiagonal() * jacobian.transpose();
}

}  // namespace

struct Localizer::Impl {
  Impl(FloorMap floor_map, MosaicTileSource tiles, const LocalizerOptions& o)
      : options(ScaledTo(o, floor_map.info.camera.floor.resolution_m)),
        map(std::move(floor_map)),
        extractor(CreateFeatureExtractor(map.info.extractor)),
        index(CreateDescriptorIndex(map.keypoints.descriptors, o.index)),
        guided(map.keypoints.keypoints, map.keypoints.descriptors, kGridCellPx * map.info.camera.floor.resolution_m),
        verifier(map.keypoints, guided, map.info.area_m2, options.registration) {
    if (tiles) {
      const ExtractorOptions& e = map.info.extractor;
      raster.emplace(std::move(tiles), map.mosaic,
                     ContrastOptions{e.normalize_radius_px > 0 ? e.normalize_radius_px : ContrastOptions().radius_px,
                                     e.smooth_sigma_px},
                     o.mosaic_memory_bytes);
    }
  }

  LocalizerOptions options;
  FloorMap map;
  std::unique_ptr<FeatureExtractor> extractor;
  std::unique_ptr<DescriptorIndex> index;
  GuidedMatcher guided;
  PoseVerifier verifier;
  std::optional<MosaicRaster> raster;

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
        pose.log_chance_votes =
            LogChancePoses(static_cast<int>(matches.size()), pose.votes, region, options.registration);
        verified.push_back(std::move(pose));
      }
    }
    return verified;
  }

  SearchRegion RegionOf(const std::optional<MatchGuide>& guide) const {
    return {guide ? std::numbers::pi * guide->radius_m * guide->radius_m : std::max(map.info.area_m2, 0.01)};
  }

  // Matches, verifies and decides; adds its times to the result's.
  void Search(const FrameView& frame, const SearchScope& scope, LocalizationResult* result) const {
    Stopwatch stage;
    const std::vector<OrientedMatch> matches = FindMatches(frame.features, scope.guide);
    result->timing.match_ms += stage.LapMs();
    std::vector<VerifiedPose> verified = VerifyCandidates(frame.features, matches, scope);
    const PoseDecision decision = Decide(frame, &verified);
    Conclude(frame, verified, decision, result);
    result->timing.register_ms += stage.LapMs();
  }

  // The best pose is laid over the mosaic; so are its rivals when the keypoints do not tell them apart.
  PoseDecision Decide(const FrameView& frame, std::vector<VerifiedPose>* poses) const {
    PoseDecision decision = DecidePose(*poses, verifier.max_distance(), options.registration);
    if (!raster || decision.best < 0) {
      return decision;
    }
    const PhotometricAligner aligner(*raster);
    const auto lay = [&](VerifiedPose* pose) {
      pose->photo = aligner.Align(frame.samples, frame.camera_center, pose->candidate.target_from_source);
    };
    if (decision.p_wrong <= kClearPWrong) {
      lay(&(*poses)[static_cast<std::size_t>(decision.best)]);
      return decision;
    }
    std::for_each(poses->begin(), poses->end(), [&](VerifiedPose& pose) { lay(&pose); });
    return DecidePose(*poses, verifier.max_distance(), options.registration);
  }

  void Conclude(const FrameView& frame, const std::vector<VerifiedPose>& verified, const PoseDecision& decision,
                LocalizationResult* result) const {
    result->status = StatusOf(decision.status);
    result->reason = ReasonOf(decision.status);
    result->p_wrong = decision.p_wrong;
    result->alternatives = decision.alternatives;
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
    double systematic_m = std::hypot(options.systematic_m, options.systematic_share * result->rms_m);
    if (best.photo && Agrees(*best.photo)) {
      result->map_from_base = best.photo->map_from_base;
      result->covariance = best.photo->covariance;
      systematic_m = options.systematic_m;
    }
    result->covariance += SystematicCovariance(result->map_from_base, frame.samples.center(), systematic_m);
  }

  // True when the picture fits, and where the keypoints say: a fit can slide off.
  bool Agrees(const PhotometricFit& photo) const {
    return photo.MeanCorrelation() >= kMinCorrelation &&
           photo.moved_m <= kMaxCorrection * options.registration.inlier_radius_m;
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

Localizer::Localizer(FloorMap map, const LocalizerOptions& options, MosaicTileSource tiles) {
  options.Check();
  impl_ = std::make_unique<Impl>(std::move(map), std::move(tiles), options);
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

  const cv::Mat prepared = impl_->extractor->Prepare(image);
  const FrameView frame{impl_->extractor->Extract(image, prepared), FrameSamples(image, prepared),
                        rectifier.camera().CameraCenter()};
  result.timing.features_ms = stage.LapMs();
  result.keypoints = static_cast<int>(frame.features.keypoints.size());
  if (result.keypoints < impl_->options.registration.min_inliers) {
    result.reason = NotLocalizedReason::kTooFewKeypoints;
    result.timing.total_ms = total.LapMs();
    return result;
  }

  SearchScope scope{prior, std::nullopt};
  if (prior) {
    scope.guide = GuideOf(*prior, rectifier.camera().floor.roi);
  }
  impl_->Search(frame, scope, &result);
  if (prior && result.status != LocalizationStatus::kLocalized) {
    scope.guide->stride = kFullStride;
    impl_->Search(frame, scope, &result);
  }
  result.timing.total_ms = total.LapMs();
  return result;
}

}  // namespace floorloc
