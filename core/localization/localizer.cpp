// SPDX-License-Identifier: Apache-2.0
#include "core/localization/localizer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "core/localization/oriented_matches.h"
#include "core/localization/photometric_aligner.h"
#include "core/localization/pose_decision.h"
#include "core/localization/pose_verifier.h"
#include "core/localization/search_scope.h"
#include "core/localization/self_similarity.h"
#include "core/registration/least_squares.h"
#include "core/registration/systematic_covariance.h"
#include "core/vision/extractors/feature_extractor.h"
#include "core/vision/matching/guided_matcher.h"

namespace floorloc {
namespace {

constexpr double kGridCellPx = 70.0;

// When too few matches are distinctive, this many neighbours of each keypoint vote, within so many bits.
constexpr int kVotesPerKeypoint = 2;
constexpr float kVoteDistance = 64.0F;

// How often a prior does not hold, as far as the localizer is concerned.
constexpr double kPriorFails = 1e-3;

// Candidates with a smaller share of the best one's matches are no rivals on a floor that does not repeat itself, when
// the best one is beyond chance by so many decades.
constexpr double kMinRivalShare = 0.25;
constexpr double kClearLogChance = -20.0;

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

// Distinctive matches of a frame, twice: matches[i] and oriented[i] are the same.
struct FrameMatches {
  std::vector<Match> matches;
  std::vector<OrientedMatch> oriented;
};

// What a frame finds on the whole map, when a prior is doubted.
struct WholeMapLook {
  std::optional<FrameMatches> matches;
  std::vector<VerifiedPose> poses;
};

}  // namespace

struct Localizer::Impl {
  Impl(FloorMap floor_map, MosaicTileSource tiles, const LocalizerOptions& o)
      : options(ScaledTo(o, floor_map.info.camera().floor.resolution_m)),
        map(std::move(floor_map)),
        extractor(CreateFeatureExtractor(map.info.extractor)),
        index(CreateDescriptorIndex(map.keypoints.descriptors, o.index)),
        guided(map.keypoints.keypoints, map.keypoints.descriptors, kGridCellPx * map.info.camera().floor.resolution_m),
        verifier(map.keypoints, guided, map.info.area_m2, options.registration),
        repeats(RepeatsItself(map.keypoints, *index, options.registration.seed)) {
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
  bool repeats;  // the floor looks alike in several places
  std::optional<MosaicRaster> raster;

  float MaxRatio() const {
    return extractor->descriptor_type() == DescriptorType::kBinary ? options.max_ratio_binary : options.max_ratio_float;
  }

  // First look: distinctive matches. With a guide a part of the keypoints is enough.
  FrameMatches FindMatches(const Features& features, const SearchScope& scope) const {
    FrameMatches found;
    if (scope.indistinct && extractor->descriptor_type() == DescriptorType::kBinary) {
      found.matches =
          FindAllNear(*index, features.descriptors, {.count = kVotesPerKeypoint, .max_distance = kVoteDistance});
    } else {
      found.matches = FilterByRatio(scope.guide ? guided.FindNearest(features, *scope.guide)
                                                : FindNearest(*index, features.descriptors, scope.probes),
                                    MaxRatio());
    }
    found.oriented = ToOrientedMatches(found.matches, features.keypoints, map.keypoints.keypoints);
    return found;
  }

  std::vector<int> Voters(const FrameMatches& matches, const VerifiedPose& pose) const {
    std::vector<int> voters;
    for (const int i :
         FindInliers(matches.oriented, pose.candidate.target_from_source, options.registration.inlier_radius_m)) {
      voters.push_back(matches.matches[static_cast<std::size_t>(i)].query);
    }
    return voters;
  }

  bool Knows(const std::vector<VerifiedPose>& poses, const Pose2& pose) const {
    return std::any_of(poses.begin(), poses.end(), [&](const VerifiedPose& v) {
      return SamePose(v.candidate.target_from_source, pose, options.registration);
    });
  }

  // Second look: all keypoints where each pose that the matches vote for predicts them. Poses that meet are one.
  std::vector<VerifiedPose> VerifyCandidates(const Features& features, const FrameMatches& matches,
                                             const SearchScope& scope) const {
    const SearchRegion region = RegionOf(scope.guide);
    std::vector<VerifiedPose> verified;
    for (const PoseCandidate& candidate : FindPoseCandidates(matches.oriented, options.registration)) {
      if (IsNoRival(candidate, verified)) {
        continue;
      }
      VerifiedPose pose = verifier.Verify(features, candidate.target_from_source);
      const Pose2& refined = pose.candidate.target_from_source;
      if (!Knows(verified, refined) && scope.Contains(refined)) {
        pose.voters = Voters(matches, pose);
        pose.log_chance_votes = LogChancePoses(static_cast<int>(matches.matches.size()),
                                               static_cast<int>(pose.voters.size()), region, options.registration);
        verified.push_back(std::move(pose));
      }
    }
    return verified;
  }

  bool IsNoRival(const PoseCandidate& candidate, const std::vector<VerifiedPose>& verified) const {
    return !repeats && !verified.empty() && verified.front().candidate.log_false_alarms < kClearLogChance &&
           static_cast<double>(candidate.inliers.size()) <
               kMinRivalShare * static_cast<double>(verified.front().voters.size());
  }

  // On a floor that repeats itself a wrong prior would be confirmed by whatever looks alike there: places outside it
  // compete, and all are judged by what is distinctive on the whole map. Looked up once per frame.
  void AddRivalsElsewhere(const Features& features, WholeMapLook* look, std::vector<VerifiedPose>* poses) const {
    if (!look->matches) {
      const SearchScope whole;
      look->matches = FindMatches(features, whole);
      look->poses = VerifyCandidates(features, *look->matches, whole);
    }
    for (VerifiedPose& pose : *poses) {
      pose.voters = Voters(*look->matches, pose);
    }
    for (const VerifiedPose& pose : look->poses) {
      if (!Knows(*poses, pose.candidate.target_from_source)) {
        poses->push_back(pose);
        poses->back().elsewhere = true;
        poses->back().prior_weight = kPriorFails;
      }
    }
  }

  SearchRegion RegionOf(const std::optional<MatchGuide>& guide) const {
    return {guide ? std::numbers::pi * guide->radius_m * guide->radius_m : std::max(map.info.area_m2, 0.01)};
  }

  // Matches, verifies and decides; adds its times to the result's.
  void Search(const FrameObservation& frame, const SearchScope& scope, WholeMapLook* look,
              LocalizationResult* result) const {
    Stopwatch stage;
    const FrameMatches matches = FindMatches(frame.features, scope);
    result->timing.match_ms += stage.LapMs();
    std::vector<VerifiedPose> verified = VerifyCandidates(frame.features, matches, scope);
    if (scope.prior && repeats && !verified.empty()) {
      AddRivalsElsewhere(frame.features, look, &verified);
    }
    const PoseDecision decision = Decide(frame, &verified);
    Conclude(frame, verified, decision, result);
    result->timing.register_ms += stage.LapMs();
  }

  // The best pose is laid over the mosaic; so are its rivals when the keypoints do not tell them apart.
  PoseDecision Decide(const FrameObservation& frame, std::vector<VerifiedPose>* poses) const {
    const PoseEvidence evidence{verifier.max_distance(), CellsOf(frame), repeats};
    PoseDecision decision = DecidePose(*poses, evidence, options.registration);
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
    return DecidePose(*poses, evidence, options.registration);
  }

  static std::vector<int> CellsOf(const FrameObservation& frame) {
    std::vector<int> cells;
    cells.reserve(frame.features.keypoints.size());
    for (const Keypoint& k : frame.features.keypoints) {
      cells.push_back(frame.samples.CellAt(k.Position()));
    }
    return cells;
  }

  void Conclude(const FrameObservation& frame, const std::vector<VerifiedPose>& verified, const PoseDecision& decision,
                LocalizationResult* result) const {
    result->status = StatusOf(decision.status);
    result->reason = ReasonOf(decision.status);
    result->p_wrong = decision.p_wrong;
    result->alternatives = decision.alternatives;
    if (decision.best < 0) {
      return;
    }
    const VerifiedPose& best = verified[static_cast<std::size_t>(decision.best)];
    if (best.elsewhere) {
      result->status = LocalizationStatus::kNotLocalized;
      result->reason = NotLocalizedReason::kContradictsPrior;
      result->p_wrong = 1.0;
      return;
    }
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
    // What a frame alone does not show: errors of the map turn and shift the floor in view.
    result->covariance += SystematicCovariance(result->map_from_base, result->map_from_base * frame.samples.center(),
                                               {systematic_m, systematic_m / kSystematicLeverM});
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

Localizer::Localizer(FloorMap map, const LocalizerOptions& options, MosaicTileSource tiles) {
  options.Check();
  impl_ = std::make_unique<Impl>(std::move(map), std::move(tiles), options);
}

Localizer::~Localizer() = default;

const FloorMap& Localizer::map() const { return impl_->map; }

FrameObservation Localizer::Observe(const Rectifier& rectifier, const cv::Mat& raw) const {
  Stopwatch stage;
  const GroundImage image = rectifier.Rectify(raw);
  const double rectify_ms = stage.LapMs();
  const cv::Mat prepared = impl_->extractor->Prepare(image);
  FrameObservation frame{impl_->extractor->Extract(image, prepared),
                         FrameSamples(image, prepared),
                         rectifier.camera().CameraCenter(),
                         rectifier.camera().floor.roi,
                         rectify_ms,
                         0.0};
  frame.features_ms = stage.LapMs();
  return frame;
}

LocalizationResult Localizer::Localize(const FrameObservation& frame, const std::optional<PosePrior>& prior) const {
  LocalizationResult result;
  result.used_prior = prior.has_value();
  result.timing.rectify_ms = frame.rectify_ms;
  result.timing.features_ms = frame.features_ms;
  result.keypoints = static_cast<int>(frame.features.keypoints.size());
  Stopwatch search;
  if (result.keypoints < impl_->options.registration.min_inliers) {
    result.reason = NotLocalizedReason::kTooFewKeypoints;
  } else {
    WholeMapLook look;
    for (const SearchScope& scope : SearchScopes(prior, frame.roi, impl_->repeats)) {
      impl_->Search(frame, scope, &look, &result);
      if (result.status == LocalizationStatus::kLocalized || result.reason == NotLocalizedReason::kContradictsPrior) {
        break;
      }
    }
  }
  result.timing.total_ms = frame.rectify_ms + frame.features_ms + search.LapMs();
  return result;
}

LocalizationResult Localizer::LocalizeHereOrAnywhere(const FrameObservation& frame,
                                                     const std::optional<PosePrior>& prior) const {
  LocalizationResult here = Localize(frame, prior);
  if (!prior || here.status != LocalizationStatus::kNotLocalized) {
    return here;
  }
  LocalizationResult anywhere = Localize(frame, std::nullopt);
  anywhere.timing.match_ms += here.timing.match_ms;
  anywhere.timing.register_ms += here.timing.register_ms;
  anywhere.timing.total_ms += here.timing.total_ms - frame.rectify_ms - frame.features_ms;
  return anywhere;
}

LocalizationResult Localizer::Localize(const Rectifier& rectifier, const cv::Mat& raw,
                                       const std::optional<PosePrior>& prior) const {
  return Localize(Observe(rectifier, raw), prior);
}

}  // namespace floorloc
