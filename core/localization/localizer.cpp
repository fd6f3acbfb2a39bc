// SPDX-License-Identifier: Apache-2.0
#include "core/localization/localizer.h"

#include <chrono>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "core/vision/feature_extractor.h"
#include "core/vision/guided_matcher.h"

namespace floorloc {
namespace {

constexpr double kGridCellM = 0.05;

// Spread of a keypoint's own angle between two views.
constexpr double kKeypointAngleNoiseRad = 0.35;

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

std::vector<OrientedMatch> ToOrientedMatches(const std::vector<Match>& matches, const Features& query,
                                             const std::vector<Keypoint>& map) {
  std::vector<OrientedMatch> oriented;
  oriented.reserve(matches.size());
  for (const Match& match : matches) {
    const Keypoint& from = query.keypoints[static_cast<std::size_t>(match.query)];
    const Keypoint& to = map[static_cast<std::size_t>(match.train)];
    oriented.push_back({from.Position(), to.Position(), from.angle_rad, to.angle_rad});
  }
  return oriented;
}

// How far a keypoint can be from its predicted place when the pose is off by the prior's radii.
MatchGuide GuideOf(const PosePrior& prior, const RectM& roi) {
  const double lever = std::max(std::hypot(roi.x_min, roi.y_min), std::hypot(roi.x_max, roi.y_max));
  return {prior.map_from_base, prior.radius_m + prior.yaw_radius_rad * lever,
          prior.yaw_radius_rad + kKeypointAngleNoiseRad};
}

}  // namespace

struct Localizer::Impl {
  Impl(FloorMap floor_map, const LocalizerOptions& o)
      : options(o),
        map(std::move(floor_map)),
        extractor(CreateFeatureExtractor(map.info.extractor)),
        index(CreateDescriptorIndex(map.keypoints.descriptors, o.index)),
        guided(map.keypoints.keypoints, map.keypoints.descriptors, kGridCellM) {}

  LocalizerOptions options;
  FloorMap map;
  std::unique_ptr<FeatureExtractor> extractor;
  std::unique_ptr<DescriptorIndex> index;
  GuidedMatcher guided;

  float MaxRatio() const {
    return extractor->descriptor_type() == DescriptorType::kBinary ? options.max_ratio_binary : options.max_ratio_float;
  }

  std::vector<OrientedMatch> FindMatches(const Features& features, const std::optional<MatchGuide>& guide) const {
    const std::vector<Match> matches =
        guide ? guided.FindNearest(features, *guide) : FindNearest(*index, features.descriptors);
    return ToOrientedMatches(FilterByRatio(matches, MaxRatio()), features, map.keypoints.keypoints);
  }

  SearchRegion RegionOf(const std::optional<MatchGuide>& guide) const {
    if (guide) {
      return {std::numbers::pi * guide->radius_m * guide->radius_m, 2.0 * guide->yaw_radius_rad};
    }
    return {std::max(map.info.area_m2, 0.01), 2.0 * std::numbers::pi};
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

  const auto guide = prior ? std::optional(GuideOf(*prior, rectifier.camera().floor.roi)) : std::nullopt;
  const std::vector<OrientedMatch> matches = impl_->FindMatches(features, guide);
  result.timing.match_ms = stage.LapMs();
  result.matches = static_cast<int>(matches.size());

  const RegistrationResult registration = RegisterSe2(matches, impl_->RegionOf(guide), impl_->options.registration);
  result.timing.register_ms = stage.LapMs();
  result.status = StatusOf(registration.status);
  result.reason = ReasonOf(registration.status);
  result.map_from_base = registration.target_from_source;
  result.covariance = registration.covariance;
  result.inliers = static_cast<int>(registration.inliers.size());
  result.rms_m = registration.rms_m;
  result.p_wrong = registration.p_wrong;
  result.alternatives = registration.alternatives;
  result.timing.total_ms = total.LapMs();
  return result;
}

}  // namespace floorloc
