// SPDX-License-Identifier: Apache-2.0
#include "core/localization/localizer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/twist.h"
#include "core/localization/candidate_search.h"
#include "core/localization/pose_decision.h"
#include "core/localization/search_scope.h"
#include "core/localization/stopwatch.h"
#include "core/photometry/photometric_aligner.h"
#include "core/registration/least_squares.h"
#include "core/registration/systematic_covariance.h"
#include "core/surface/texture/floor_recognizer.h"
#include "core/vision/extractors/feature_extractor.h"
#include "core/vision/matching/guided_matcher.h"

namespace floorloc {
namespace {

LocalizerOptions ScaledTo(LocalizerOptions options, double resolution_m) {
  options.registration = options.registration.ScaledTo(resolution_m);
  return options;
}

NotLocalizedReason ReasonOf(RegistrationStatus status) {
  switch (status) {
    case RegistrationStatus::kTooFewMatches:
      return NotLocalizedReason::kTooFewMatches;
    case RegistrationStatus::kTooFewInliers:
      return NotLocalizedReason::kTooFewInliers;
    case RegistrationStatus::kNotSignificant:
      return NotLocalizedReason::kNotSignificant;
    case RegistrationStatus::kViewDisagrees:
      return NotLocalizedReason::kViewDisagrees;
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
  }

  LocalizerOptions options;
  FloorMap map;
  std::unique_ptr<FeatureExtractor> extractor;
  CandidateSearch search;
  std::optional<MosaicRaster> raster;
  std::optional<LatticeComparer> lattice;
  FloorRecognizer recognizer;

  // Searches, decides and reports; adds its times to the result's. All poses are relative to the keypoints' origin.
  void LocalizeIn(const SearchScope& scope, const FrameObservation& frame, GlobalSearchCache* global,
                  LocalizationResult* result) const {
    Stopwatch stage;
    const FrameMatches matches = search.FindMatches(frame, scope);
    result->timing.match_ms += stage.LapMs();
    std::vector<VerifiedPose> poses = search.FindPoses(frame, scope, matches, global);
    const PoseDecision decision = Decide(frame, scope, global, &poses);
    FillResult(frame, poses, decision, result);
    result->timing.register_ms += stage.LapMs();
  }

  // The best pose is aligned to the mosaic; so are its rivals when the keypoints alone do not decide or the view does
  // not agree. On a lattice its other places are compared then.
  PoseDecision Decide(const FrameObservation& frame, const SearchScope& scope, GlobalSearchCache* global,
                      std::vector<VerifiedPose>* poses) const {
    PoseEvidence evidence{search.max_distance(), CellsOf(frame), search.floor_repeats()};
    PoseDecision decision = DecidePose(*poses, evidence, options.registration, options.decision);
    if (!raster || decision.best < 0 || !IsComparable(frame.samples)) {
      return decision;
    }
    const PhotometricAligner aligner(*raster, options.photometric);
    if (decision.p_wrong <= options.decision.clear_p_wrong) {
      VerifiedPose& best = (*poses)[static_cast<std::size_t>(decision.best)];
      Align(aligner, frame.samples, &best);
      const double p_local = best.view ? best.view->LocalProbability() : 0.0;
      if (p_local <= options.decision.clear_p_wrong) {
        decision.p_wrong = std::max(decision.p_wrong, p_local);
        return decision;
      }
    }
    std::for_each(poses->begin(), poses->end(), [&](VerifiedPose& pose) {
      if (!pose.photo) {
        Align(aligner, frame.samples, &pose);
      }
    });
    decision = DecidePose(*poses, evidence, options.registration, options.decision);
    if (!lattice || decision.best < 0 || decision.p_wrong <= options.decision.clear_p_wrong) {
      return decision;
    }
    const LatticeComparison* places =
        ComparePlaces(frame, scope, (*poses)[static_cast<std::size_t>(decision.best)], &global->places);
    if (places == nullptr) {
      return decision;
    }
    AddLikelyPlaces(frame, *places, poses);
    evidence.lattice = places;
    return DecidePose(*poses, evidence, options.registration, options.decision);
  }

  // Fine structure is lost in a mosaic much coarser than the frame: it agrees by chance, and the keypoints, which are
  // from survey frames, tell the pose better.
  bool IsComparable(const FrameSamples& samples) const {
    return raster->resolution_m() <= options.decision.max_mosaic_coarseness * samples.resolution_m();
  }

  // At every place of the lattice where the frame may be if it is at this pose or at another place like it; nullptr:
  // too few can be compared. compared: of an earlier scope, used again where it has the pose.
  const LatticeComparison* ComparePlaces(const FrameObservation& frame, const SearchScope& scope,
                                         const VerifiedPose& pose, std::optional<LatticeComparison>* compared) const {
    if (!Agrees(*pose.photo)) {
      return nullptr;
    }
    const Pose2 map_from_origin = map.keypoints.MapFromOrigin();
    if (!*compared || (*compared)->Find(pose.photo->map_from_base) == nullptr) {
      PhotometricFit fit = *pose.photo;
      fit.map_from_base = map_from_origin * fit.map_from_base;
      *compared = lattice->Compare(frame.samples, fit);
      if (!*compared) {
        return nullptr;
      }
      for (LatticePlace& place : (*compared)->places) {
        place.map_from_base = map_from_origin.Inverse() * place.map_from_base;
      }
    }
    for (LatticePlace& place : (*compared)->places) {
      place.prior_weight = scope.Contains(place.map_from_base) ? 1.0 : options.search.prior_failure_rate;
    }
    (*compared)->prior_weight_elsewhere = scope.prior ? options.search.prior_failure_rate : 1.0;
    return &**compared;
  }

  // Makes the likely places that the search did not find poses.
  void AddLikelyPlaces(const FrameObservation& frame, const LatticeComparison& compared,
                       std::vector<VerifiedPose>* poses) const {
    const PhotometricAligner aligner(*raster, options.photometric);
    const double least = compared.places.front().log_likelihood + std::log(options.registration.max_p_wrong);
    for (const LatticePlace& place : compared.places) {
      const bool known = std::any_of(poses->begin(), poses->end(), [&](const VerifiedPose& pose) {
        return compared.Find(pose.candidate.target_from_source) == &place;
      });
      if (known || place.log_likelihood < least) {
        continue;
      }
      if (static_cast<int>(poses->size()) >= options.lattice_comparison.max_poses) {
        return;
      }
      VerifiedPose pose = search.Verify(frame, place.map_from_base);
      Align(aligner, frame.samples, &pose);
      pose.outside_prior = place.prior_weight < 1.0;
      pose.prior_weight = place.prior_weight;
      poses->push_back(std::move(pose));
    }
  }

  void Align(const PhotometricAligner& aligner, const FrameSamples& samples, VerifiedPose* pose) const {
    const Pose2 map_from_origin = map.keypoints.MapFromOrigin();
    const bool rough = static_cast<int>(pose->candidate.inliers.size()) < options.photometric.sure_inliers;
    pose->photo = aligner.Align(samples, map_from_origin * pose->candidate.target_from_source, rough);
    pose->photo->map_from_base = map_from_origin.Inverse() * pose->photo->map_from_base;
    std::vector<float> cells = pose->photo->ComparedCells();
    if (!cells.empty()) {
      pose->view = MeasureViewSupport(std::move(cells), {options.decision.cell_sigma, options.decision.local_share});
    }
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
    const double sigma_m = options.photometric.readout_motion_share * VelocityAt(motion, samples->center()).norm();
    if (sigma_m > 0.0) {
      samples->SetReadout(camera, sigma_m);
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
    return scopes;
  }

  static std::vector<int> CellsOf(const FrameObservation& frame) {
    std::vector<int> cells;
    cells.reserve(frame.features.keypoints.size());
    for (const Keypoint& k : frame.features.keypoints) {
      cells.push_back(frame.samples.CellAt(k.Position()));
    }
    return cells;
  }

  void FillResult(const FrameObservation& frame, const std::vector<VerifiedPose>& poses, const PoseDecision& decision,
                  LocalizationResult* result) const {
    result->status = StatusOf(decision.status);
    result->reason = ReasonOf(decision.status);
    result->p_wrong = decision.p_wrong;
    result->alternatives = decision.alternatives;
    if (decision.best < 0) {
      return;
    }
    const VerifiedPose& best = poses[static_cast<std::size_t>(decision.best)];
    if (best.outside_prior) {
      result->status = LocalizationStatus::kNotLocalized;
      result->reason = NotLocalizedReason::kContradictsPrior;
      result->p_wrong = 1.0;
      return;
    }
    FillPose(best, frame.samples.center(), result);
    if (best.view) {
      result->support_area = best.view->area;
    }
    // The camera's place in the robot: no image shows its error, which is the same in all frames.
    result->covariance.topLeftCorner<2, 2>().diagonal().array() += frame.offset_sigma_m * frame.offset_sigma_m;
  }

  // center_in_base: centre of the visible floor, metres.
  void FillPose(const VerifiedPose& best, const Eigen::Vector2d& center_in_base, LocalizationResult* result) const {
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
      result->camera = best.photo->camera;
      systematic_m = options.systematic_m;
    }
    // Errors that residuals do not show: those of the map shift and rotate the visible floor as a whole.
    result->covariance += SystematicCovariance(result->map_from_base, result->map_from_base * center_in_base,
                                               {systematic_m, systematic_m / options.systematic_lever_m});
  }

  // True when the frame correlates with the mosaic near the pose by keypoints: a fit can diverge.
  bool Agrees(const PhotometricFit& photo) const {
    return photo.MeanCorrelation() >= options.photometric.min_correlation &&
           photo.moved_m <= options.photometric.max_correction_radii * options.registration.inlier_radius_m;
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
      impl_->LocalizeIn(scope, frame, &global, &result);
      if (result.status == LocalizationStatus::kLocalized || result.reason == NotLocalizedReason::kContradictsPrior) {
        break;
      }
    }
    result.map_from_base = map_from_origin * result.map_from_base;
    for (PoseHypothesis& other : result.alternatives) {
      other.target_from_source = map_from_origin * other.target_from_source;
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
