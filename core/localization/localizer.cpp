// SPDX-License-Identifier: Apache-2.0
#include "core/localization/localizer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/twist.h"
#include "core/localization/candidate_search.h"
#include "core/localization/frame_decider.h"
#include "core/localization/frame_report.h"
#include "core/localization/search_scope.h"
#include "core/localization/stopwatch.h"
#include "core/surface/texture/floor_recognizer.h"
#include "core/vision/extractors/feature_extractor.h"
#include "core/vision/matching/guided_matcher.h"

namespace floorloc {
namespace {

LocalizerOptions ScaledTo(LocalizerOptions options, double resolution_m) {
  options.registration = options.registration.ScaledTo(resolution_m);
  return options;
}

NotLocalizedReason ReasonOf(StrangeView view) {
  return view == StrangeView::kNoFloor ? NotLocalizedReason::kNoFloor : NotLocalizedReason::kOtherFloor;
}

// What the floors of all surveys look like; nothing where that is not known of one of them.
std::vector<FloorTextureModel> FloorsOf(const MapInfo& info) {
  std::vector<FloorTextureModel> floors;
  for (const MapFloorTexture& floor : info.floor_textures) {
    if (floor.blocks > 0) {
      floors.push_back({floor.blocks, floor.mean, floor.covariance});
    }
  }
  return floors.size() == info.cameras.size() ? floors : std::vector<FloorTextureModel>();
}

}  // namespace

struct Localizer::Impl {
  Impl(FloorMap floor_map, MosaicTileSource tiles, const LocalizerOptions& o)
      : options(ScaledTo(o, floor_map.info.camera().floor.resolution_m)),
        map(std::move(floor_map)),
        extractor(CreateFeatureExtractor(map.info.extractor)),
        search(map, extractor->descriptor_type(), options),
        recognizer(FloorsOf(map.info), options.floor) {
    if (tiles) {
      raster.emplace(std::move(tiles), map.mosaic, ContrastOfMosaic(map.info.extractor), o.mosaic_memory_bytes);
      if (const std::optional<FloorLattice> found = search.FindLattice()) {
        lattice.emplace(*raster, *found, map.info.extent, options.lattice_comparison,
                        options.photometric.min_cell_samples);
      }
    }
    decider.emplace(DecisionSources{map, search, raster ? &*raster : nullptr, lattice ? &*lattice : nullptr}, options);
  }

  LocalizerOptions options;
  FloorMap map;
  std::unique_ptr<FeatureExtractor> extractor;
  CandidateSearch search;
  std::optional<MosaicRaster> raster;
  std::optional<LatticeComparer> lattice;
  FloorRecognizer recognizer;
  std::optional<FrameDecider> decider;

  // Searches, decides and reports; adds its times to the result's. All poses are relative to the keypoints' origin.
  void LocalizeIn(const SearchScope& scope, const FrameObservation& frame, GlobalSearchCache* global,
                  LocalizationResult* result) const {
    Stopwatch stage;
    const FrameMatches matches = search.FindMatches(frame, scope);
    result->timing.match_ms += stage.LapMs();
    std::vector<VerifiedPose> poses = search.FindPoses(frame, scope, matches, global);
    PoseDecision decision = decider->Decide(frame, scope, global, &poses);
    if (scope.IsUnquestioned(options.search)) {
      decision.p_wrong = std::max(decision.p_wrong, *scope.prior->p_elsewhere);
    }
    const DecidedSearch decided{scope, poses, decision};
    FillResult(frame, decided, options, result);
    result->lattice = lattice ? ObserveLattice(frame, decided, global->places, options) : std::nullopt;
    if (result->lattice) {
      result->lattice->lattice = lattice->lattice();
      result->lattice->map_extent = map.info.extent;
    }
    result->timing.register_ms += stage.LapMs();
  }

  FrameObservation ObserveParts(const Rectifier& rectifier, const cv::Mat& raw, const ViewParts& parts,
                                const Eigen::Vector3d& motion) const {
    Stopwatch stage;
    const PartialView view = RectifyParts(rectifier, raw, parts, {*extractor, motion});
    const double rectify_ms = stage.LapMs();
    const GroundGrid& grid = view.keypoint_image.grid;
    const Eigen::Vector2d low = grid.BaseFromPixel(grid.width_px - 0.5, grid.height_px - 0.5);
    const Eigen::Vector2d high = grid.BaseFromPixel(-0.5, -0.5);
    UprightImage upright;
    Features features = extractor->Extract(view.keypoint_image, view.keypoint_prepared, &upright);
    FrameObservation frame{std::move(features),
                           std::move(upright),
                           FrameSamples(view.image, view.prepared, rectifier),
                           RectM{low.x(), high.x(), low.y(), high.y()},
                           rectifier.camera().floor.offset_sigma_m,
                           GroundImage(),
                           rectify_ms,
                           0.0};
    SetReadout(rectifier.camera(), motion, &frame.samples);
    frame.features_ms = stage.LapMs();
    return frame;
  }

  // motion: as that of Observe.
  void SetReadout(const FloorCamera& camera, const Eigen::Vector3d& motion, FrameSamples* samples) const {
    const PhotometricOptions& known = options.photometric;
    const double motion_m = VelocityAt(motion, samples->center()).norm();
    const double sigma_m = known.readout_motion_share * motion_m;
    const double sigma_rad =
        std::hypot(known.readout_motion_share * motion.z(), known.readout_turn_sigma_rad_per_m * motion_m);
    if (sigma_m > 0.0 && sigma_rad > 0.0) {
      samples->SetReadout(camera, {sigma_m, sigma_m, sigma_rad});
    }
  }

  bool IsPoor(const FrameObservation& frame) const {
    return frame.jpeg_quality && *frame.jpeg_quality < options.search.poor_jpeg_quality;
  }

  // Nothing is said of a view of which only parts are known, of one whose blur was undone, and of one whose compression
  // took the fine structures.
  FloorVerdict Look(const FrameObservation& frame) const {
    return frame.deblurred || IsPoor(frame) ? FloorVerdict() : recognizer.Look(LeaveOut(frame.floor, frame.left_out));
  }

  std::vector<SearchScope> ScopesOf(const FrameObservation& frame, const std::optional<PosePrior>& prior) const {
    std::vector<SearchScope> scopes = SearchScopes(prior, frame.roi, search.searchable(), options.search);
    // On a self-similar floor weaker matches would speak for every copy.
    if (IsPoor(frame) && !search.floor_repeats()) {
      scopes.push_back(ThoroughScope(prior, frame.roi, search.searchable(), options.search));
    }
    if (lattice && !prior) {
      scopes.push_back(ModuloScope(lattice->lattice(), search.searchable(), options.search));
    }
    return scopes;
  }
};

Localizer::Localizer(FloorMap map, const LocalizerOptions& options, MosaicTileSource tiles) {
  options.Check();
  impl_ = std::make_unique<Impl>(std::move(map), std::move(tiles), options);
}

Localizer::~Localizer() = default;

const FloorMap& Localizer::map() const { return impl_->map; }

const LocalizerOptions& Localizer::options() const { return impl_->options; }

FrameObservation Localizer::Observe(const Rectifier& rectifier, const cv::Mat& raw, const Eigen::Vector3d& motion,
                                    const cv::Mat& left_out) const {
  Stopwatch stage;
  const GroundImage floor = rectifier.Rectify(raw, motion);
  const GroundImage image = LeaveOut(floor, left_out);
  const double rectify_ms = stage.LapMs();
  const cv::Mat prepared = impl_->extractor->Prepare(image);
  UprightImage upright;
  Features features = impl_->extractor->Extract(image, prepared, &upright);
  FrameObservation frame{std::move(features),
                         std::move(upright),
                         FrameSamples(image, prepared, rectifier),
                         rectifier.camera().floor.roi,
                         rectifier.camera().floor.offset_sigma_m,
                         floor,
                         rectify_ms,
                         0.0};
  impl_->SetReadout(rectifier.camera(), motion, &frame.samples);
  frame.features_ms = stage.LapMs();
  frame.left_out = left_out;
  return frame;
}

std::optional<FrameObservation> Localizer::Deblur(const FrameObservation& frame, const Eigen::Vector3d& twist,
                                                  const cv::Mat& left_out) const {
  const MotionBlurOptions& options = impl_->options.motion_blur;
  const Eigen::Vector2d velocity = VelocityAt(twist, frame.samples.center());
  const double shortest_m = options.min_length_px * frame.samples.resolution_m();
  if (frame.floor.gray.empty() || !(velocity.norm() * options.max_exposure_s >= shortest_m)) {
    return std::nullopt;
  }
  Stopwatch stage;
  GroundImage image = LeaveOut(frame.floor, left_out);
  // Image rows run against x, columns against y.
  const Eigen::Vector2d direction = Eigen::Vector2d(-velocity.y(), -velocity.x()).normalized();
  const std::optional<cv::Mat> sharp = UndoMotionBlur(impl_->extractor->Prepare(image), direction, options);
  if (!sharp) {
    return std::nullopt;
  }
  image.gray = *sharp;
  FrameObservation deblurred = frame;
  deblurred.features = impl_->extractor->Extract(image, impl_->extractor->Prepare(image), &deblurred.upright);
  deblurred.rectify_ms = 0.0;
  deblurred.deblurred = true;
  deblurred.features_ms = stage.LapMs();
  return deblurred;
}

std::optional<ReadoutMeasurement> Localizer::MeasureReadout(const FrameObservation& frame, const FloorCamera& camera,
                                                            const MovingPrior& prior) const {
  PosePrior near = prior.near;
  near.map_from_base = impl_->map.keypoints.MapFromOrigin().Inverse() * near.map_from_base;
  if (!ShowsReadout(frame.roi, prior.twist, impl_->options.readout_fit)) {
    return std::nullopt;
  }
  const SearchScope scope = SearchScopes(near, frame.roi, impl_->search.searchable(), impl_->options.search).back();
  const FrameMatches found = impl_->search.FindMatches(frame, scope);
  ReadoutProblem problem{found.oriented, {}, prior.twist, camera.floor.resolution_m};
  for (const OrientedMatch& match : problem.matches) {
    problem.share.push_back(ReadoutShare(camera.camera, camera.RawPixelFromFloor(match.source_m)));
  }
  return FitReadout(problem, impl_->options.registration, impl_->options.readout_fit);
}

std::vector<CompetingPose> Localizer::Compete(const FrameObservation& frame, const LocalizationResult& result,
                                              std::size_t max_poses) const {
  return FindCompetingPoses(
      {impl_->search, impl_->options.registration, impl_->map.keypoints.MapFromOrigin(), max_poses}, frame, result);
}

LocalizationResult Localizer::Localize(const FrameObservation& frame, const std::optional<PosePrior>& prior) const {
  LocalizationResult result;
  result.used_prior = prior.has_value();
  result.timing.rectify_ms = frame.rectify_ms;
  result.timing.features_ms = frame.features_ms;
  result.keypoints = static_cast<int>(frame.features.keypoints.size());
  result.poor_jpeg_quality = impl_->IsPoor(frame) ? frame.jpeg_quality : std::nullopt;
  Stopwatch search;
  // Near a prior the search costs less than it would to look whether it is hopeless.
  std::optional<FloorVerdict> view = prior ? std::nullopt : std::optional(impl_->Look(frame));
  if (view && view->hopeless) {
    result.reason = ReasonOf(*view->strange);
  } else if (result.keypoints < impl_->options.registration.min_inliers) {
    result.reason = NotLocalizedReason::kTooFewKeypoints;
  } else {
    const Pose2 map_from_origin = impl_->map.keypoints.MapFromOrigin();
    std::optional<PosePrior> near = prior;
    if (near) {
      near->map_from_base = map_from_origin.Inverse() * near->map_from_base;
    }
    GlobalSearchCache global;
    for (const SearchScope& scope : impl_->ScopesOf(frame, near)) {
      if (scope.modulo && result.status == LocalizationStatus::kAmbiguous) {
        break;  // its places were compared
      }
      impl_->LocalizeIn(scope, frame, &global, &result);
      if (result.status == LocalizationStatus::kLocalized || result.reason == NotLocalizedReason::kContradictsPrior) {
        break;
      }
    }
    result.map_from_base = map_from_origin * result.map_from_base;
    for (PoseHypothesis& other : result.alternatives) {
      other.target_from_source = map_from_origin * other.target_from_source;
    }
    if (result.lattice) {
      result.lattice->map_from_base = map_from_origin * result.lattice->map_from_base;
      for (LatticePlace& place : result.lattice->places) {
        place.map_from_base = map_from_origin * place.map_from_base;
      }
    }
  }
  if (result.status == LocalizationStatus::kNotLocalized && result.reason != NotLocalizedReason::kContradictsPrior) {
    view = view ? view : impl_->Look(frame);
    result.reason = view->strange ? ReasonOf(*view->strange) : result.reason;
  }
  result.timing.total_ms = frame.rectify_ms + frame.features_ms + search.LapMs();
  return result;
}

LocalizationResult Localizer::LocalizeWithGlobalFallback(const FrameObservation& frame,
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

std::optional<FrameObservation> Localizer::ObservePart(const Rectifier& rectifier, const cv::Mat& raw,
                                                       const Eigen::Vector3d& motion) const {
  const RectM& map_roi = impl_->map.info.camera().floor.roi;
  const ViewParts parts =
      ChooseViewParts(rectifier, map_roi.width_m() * map_roi.height_m(), impl_->options.partial_view);
  return parts.keypoints.empty() ? std::nullopt : std::optional(impl_->ObserveParts(rectifier, raw, parts, motion));
}

LocalizationResult Localizer::Localize(const Rectifier& rectifier, const cv::Mat& raw,
                                       const std::optional<PosePrior>& prior) const {
  LocalizationResult by_part;
  if (const std::optional<FrameObservation> part = ObservePart(rectifier, raw)) {
    by_part = Localize(*part, prior);
    if (by_part.status == LocalizationStatus::kLocalized) {
      return by_part;
    }
  }
  LocalizationResult whole = Localize(Observe(rectifier, raw), prior);
  whole.timing += by_part.timing;
  return whole;
}

}  // namespace floorloc
