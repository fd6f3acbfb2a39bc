// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/self_calibration/self_calibration.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <stdexcept>

#include "core/geometry/mounting.h"
#include "core/geometry/option_check.h"
#include "core/io/input_error.h"
#include "core/map/camera_correction.h"
#include "mapbuilder/keypoints/keypoint_tracks.h"
#include "mapbuilder/self_calibration/observation_builder.h"

namespace floorloc {
namespace {

// Prior standard deviations of calibration errors when the user asks for them: roll, pitch, height, focal length, k1,
// k2, p1, p2.
constexpr CameraPriors kPriorSigma = {0.03, 0.03, 0.05, 0.03, 0.1, 0.1, 0.005, 0.005};

// A round of the calibration. Before the camera is calibrated, views of one floor point scatter more, and a share of
// the observations is enough.
struct Round {
  double track_radius_factor;
  double observation_share;
};
constexpr std::array<Round, 4> kRounds = {{{2.5, 0.4}, {1.0, 1.0}, {1.0, 1.0}, {1.0, 1.0}}};

constexpr double kDistanceSigmaM = 1e-3;

// What a usual calibration leaves: roll, pitch (0.2 degrees), height, focal length (0.5 %), k1, k2, p1, p2 (half a
// pixel at the corner of a 640 x 480 image). An unknown that the images tell worse is better left as given.
constexpr CameraPriors kUsualSigma = {3.5e-3, 3.5e-3, 5e-3, 5e-3, 0.01, 0.03, 1e-3, 1e-3};

constexpr int Index(CameraUnknown unknown) { return static_cast<int>(unknown); }

bool IsTangential(int unknown) { return unknown == Index(CameraUnknown::kP1) || unknown == Index(CameraUnknown::kP2); }

class Calibrator {
 public:
  // Calibrates the result's frames, surveys and placement in place.
  Calibrator(CalibratedFrames* result, const SelfCalibrationOptions& options)
      : frames_(result->set.frames), surveys_(result->set.surveys), placement_(result->placement), options_(options) {}

  SelfCalibration Run();

 private:
  // What Apply() changes.
  struct Original {
    std::vector<FloorCamera> cameras;
    std::vector<std::vector<Keypoint>> keypoints;
    std::vector<std::optional<Pose2>> map_from_base;
  };

  bool HasScaleConstraint() const;
  void ChooseUnknowns();
  Original Remember() const;
  void Restore(const Original& original);
  // Applies round after round until the calibration settles; returns the last round's result.
  BundleSummary RunRounds();
  // Holds constant what the images do not tell; true when there is such an unknown.
  bool LeaveOutUntold(const BundleSummary& summary);
  bool NothingAsked() const;
  // Why the calibration must not be used; empty: it may be.
  std::string ReasonToGiveUp(const BundleSummary& last) const;
  Bundle MakeBundle(const Round& round);
  void ChooseTracks(const Round& round, const std::vector<ObservationBuilder>& builders, Bundle* bundle) const;
  void AddAbsoluteConstraints(const std::vector<ObservationBuilder>& builders, Bundle* bundle) const;
  // Returns by how many pixels of the rectified image the calibration moved the floor at most.
  double Apply(const Bundle& bundle, const BundleSummary& summary);
  void Finish(const BundleSummary& last);
  void RemeasureLinks();

  std::vector<BuildFrame>& frames_;
  std::vector<LoadedSurvey>& surveys_;
  Placement& placement_;
  const SelfCalibrationOptions& options_;
  std::vector<CameraPriors> priors_;  // one per survey; 0: held constant
  double inflation_ = 1.0;            // of standard deviations, since the observations' errors are correlated
  SelfCalibration result_;
};

SelfCalibration Calibrator::Run() {
  ChooseUnknowns();
  const Original original = Remember();
  Restore(original);
  BundleSummary last = RunRounds();
  if (options_.automatic && LeaveOutUntold(last)) {
    Restore(original);
    last = NothingAsked() ? last : RunRounds();
  }
  result_.given_up = ReasonToGiveUp(last);
  if (!result_.given_up.empty()) {
    Restore(original);
    return result_;
  }
  Finish(last);
  RemeasureLinks();
  return result_;
}

Calibrator::Original Calibrator::Remember() const {
  Original original;
  for (const LoadedSurvey& loaded : surveys_) {
    original.cameras.push_back(loaded.survey.camera);
  }
  for (const BuildFrame& frame : frames_) {
    original.keypoints.push_back(frame.features.keypoints);
  }
  original.map_from_base = placement_.map_from_base;
  return original;
}

void Calibrator::Restore(const Original& original) {
  result_.cameras.resize(surveys_.size());
  for (std::size_t s = 0; s < surveys_.size(); ++s) {
    surveys_[s].survey.camera = original.cameras[s];
    result_.cameras[s].given = result_.cameras[s].camera = original.cameras[s];
    result_.cameras[s].change.setZero();
    result_.cameras[s].sigma.setZero();
  }
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    frames_[i].features.keypoints = original.keypoints[i];
    frames_[i].mounting_error = MountingError();
  }
  placement_.map_from_base = original.map_from_base;
}

BundleSummary Calibrator::RunRounds() {
  BundleSummary summary;
  for (std::size_t round = 0; round < kRounds.size(); ++round) {
    Bundle bundle = MakeBundle(kRounds[round]);
    summary = AdjustBundle(&bundle);
    inflation_ = std::max(1.0, options_.error_correlation * summary.rms_after_m / bundle.observation_sigma_m);
    result_.rms_before_m = round == 0 ? summary.rms_before_m : result_.rms_before_m;
    result_.rms_after_m = summary.rms_after_m;
    result_.tracks = static_cast<int>(bundle.tracks.size());
    const double moved_px = Apply(bundle, summary);
    if (round > 0 && moved_px < options_.settled_px) {
      break;
    }
  }
  return summary;
}

bool Calibrator::HasScaleConstraint() const {
  const bool poses =
      std::any_of(frames_.begin(), frames_.end(), [](const BuildFrame& frame) { return frame.prior.has_value(); });
  const auto fixes_scale = [](const LoadedSurvey& loaded) {
    return loaded.survey.control_points.size() > 1 || !loaded.survey.known_distances.empty();
  };
  return poses || std::any_of(surveys_.begin(), surveys_.end(), fixes_scale);
}

void Calibrator::ChooseUnknowns() {
  using enum CameraUnknown;
  const bool scale = HasScaleConstraint();
  std::vector<CameraUnknown> unknowns = options_.unknowns;
  if (options_.automatic) {
    unknowns = {kRoll, kPitch, kK1, kK2, kP1, kP2};
    if (scale) {
      unknowns.push_back(kHeight);
    }
  }
  const auto asked = [&](CameraUnknown unknown) {
    return std::find(unknowns.begin(), unknowns.end(), unknown) != unknowns.end();
  };
  if ((asked(kHeight) || asked(kFocal)) && !scale) {
    throw InputError(
        "height and focal length are not observable from images alone; add control_points.csv, known_distances.csv, "
        "--markers or --poses, or leave them out of --self-calibrate");
  }
  for (const LoadedSurvey& loaded : surveys_) {
    CameraPriors priors{};
    for (const CameraUnknown unknown : unknowns) {
      const int i = Index(unknown);
      const bool exists =
          !IsTangential(i) || loaded.survey.camera.camera.distortion_model != DistortionModel::kEquidistant;
      const CameraPriors& sigma = options_.automatic ? kUsualSigma : kPriorSigma;
      priors[static_cast<std::size_t>(i)] = exists ? sigma[static_cast<std::size_t>(i)] : 0.0;
    }
    priors_.push_back(priors);
  }
}

bool Calibrator::LeaveOutUntold(const BundleSummary& summary) {
  bool some = false;
  for (std::size_t s = 0; s < surveys_.size(); ++s) {
    CalibratedCamera& camera = result_.cameras[s];
    for (int i = 0; i < kCameraUnknowns; ++i) {
      double& prior = priors_[s][static_cast<std::size_t>(i)];
      const double sigma = inflation_ * std::sqrt(summary.camera_covariance[s](i, i));
      const double limit = options_.observable_share * kUsualSigma[static_cast<std::size_t>(i)];
      const bool contradicted = std::abs(camera.change[i]) > options_.contradiction_sigmas * sigma;
      if (prior > 0.0 && !(sigma > 0.0 && (sigma < limit || contradicted))) {
        camera.unobserved.push_back(static_cast<CameraUnknown>(i));
        prior = 0.0;
        some = true;
      }
    }
  }
  return some;
}

bool Calibrator::NothingAsked() const {
  return std::all_of(priors_.begin(), priors_.end(), [](const CameraPriors& priors) {
    return std::all_of(priors.begin(), priors.end(), [](double prior) { return prior <= 0.0; });
  });
}

std::string Calibrator::ReasonToGiveUp(const BundleSummary& last) const {
  if (!options_.automatic) {
    return "";
  }
  if (NothingAsked()) {
    return "the images tell it no better than the calibration does";
  }
  if (!last.converged) {
    return "the adjustment did not converge";
  }
  const double scatter_px = result_.rms_after_m / surveys_.front().survey.camera.floor.resolution_m;
  if (scatter_px > options_.max_scatter_px) {
    return "floor points scatter by more than the lens and the mounting explain: is the floor plane, and the camera's "
           "height constant?";
  }
  return "";
}

Bundle Calibrator::MakeBundle(const Round& round) {
  Bundle bundle;
  std::vector<ObservationBuilder> builders;
  for (const LoadedSurvey& loaded : surveys_) {
    builders.emplace_back(loaded.survey.camera);
  }
  bundle.cameras.assign(surveys_.size(), CameraAdjustment::Zero());
  bundle.tilts.assign(frames_.size(), Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    bundle.map_from_base.push_back(placement_.map_from_base[i].value_or(Pose2()));
    bundle.camera_of_frame.push_back(frames_[i].survey);
  }
  for (const CalibratedCamera& camera : result_.cameras) {
    bundle.earlier_change.push_back(camera.change);
  }
  bundle.prior = {priors_, options_.tilt_rad, options_.tilt_height};
  for (CameraPriors& priors : bundle.prior.cameras) {
    // Instead of less weight for the observations, whose loss is robust at their own scatter.
    std::transform(priors.begin(), priors.end(), priors.begin(), [&](double sigma) { return sigma / inflation_; });
  }
  bundle.observation_sigma_m = options_.observation_sigma_px * surveys_.front().survey.camera.floor.resolution_m;
  ChooseTracks(round, builders, &bundle);
  AddAbsoluteConstraints(builders, &bundle);
  if (bundle.priors.empty() && bundle.control_points.empty()) {
    const auto first = std::find_if(placement_.map_from_base.begin(), placement_.map_from_base.end(),
                                    [](const auto& pose) { return pose.has_value(); });
    bundle.fixed = {static_cast<int>(first - placement_.map_from_base.begin())};
  }
  return bundle;
}

// Chooses the longest tracks first, as long as one of their frames has too few observations.
void Calibrator::ChooseTracks(const Round& round, const std::vector<ObservationBuilder>& builders,
                              Bundle* bundle) const {
  TrackOptions track_options = TrackOptions().ForCamera(surveys_.front().survey.camera.floor);
  track_options.radius_m *= round.track_radius_factor;
  const auto enough = static_cast<int>(std::ceil(round.observation_share * options_.observations_per_frame));
  track_options.min_views = 2;
  std::vector<KeypointTrack> tracks = FindTracks(frames_, placement_.map_from_base, track_options);
  std::stable_sort(tracks.begin(), tracks.end(),
                   [](const auto& a, const auto& b) { return a.views.size() > b.views.size(); });
  std::vector<int> used(frames_.size(), 0);
  for (const KeypointTrack& track : tracks) {
    const bool wanted = std::any_of(track.views.begin(), track.views.end(), [&](const auto& view) {
      return used[static_cast<std::size_t>(view.first)] < enough;
    });
    if (!wanted) {
      continue;
    }
    ObservedTrack observed;
    observed.position_m = track.position_m;
    for (const auto& [frame, keypoint] : track.views) {
      const BuildFrame& from = frames_[static_cast<std::size_t>(frame)];
      ++used[static_cast<std::size_t>(frame)];
      observed.observations.push_back(builders[static_cast<std::size_t>(from.survey)].Make(
          frame, from.features.keypoints[static_cast<std::size_t>(keypoint)].Position()));
    }
    bundle->tracks.push_back(std::move(observed));
  }
}

void Calibrator::AddAbsoluteConstraints(const std::vector<ObservationBuilder>& builders, Bundle* bundle) const {
  std::map<std::pair<int, std::string>, int> by_name;
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (!placement_.map_from_base[i]) {
      continue;
    }
    by_name[{frames_[i].survey, frames_[i].info.filename}] = static_cast<int>(i);
    if (const std::optional<AbsolutePosePrior>& prior = frames_[i].prior) {
      bundle->priors.push_back({static_cast<int>(i), prior->map_from_base, prior->covariance});
    }
  }
  for (std::size_t s = 0; s < surveys_.size(); ++s) {
    const auto observe = [&](const std::string& file, const Eigen::Vector2d& raw_px) -> std::optional<Observation> {
      const auto frame = by_name.find({static_cast<int>(s), file});
      if (frame == by_name.end()) {
        return std::nullopt;
      }
      return builders[s].Make(frame->second, builders[s].camera().FloorFromRawPixel(raw_px));
    };
    for (const ControlPoint& point : surveys_[s].survey.control_points) {
      if (const auto observation = observe(point.filename, point.raw_px)) {
        bundle->control_points.push_back({*observation, point.point_in_map_m, ControlPointFactor().sigma_m});
      }
    }
    for (const KnownDistance& distance : surveys_[s].survey.known_distances) {
      const auto first = observe(distance.first_filename, distance.first_raw_px);
      const auto second = observe(distance.second_filename, distance.second_raw_px);
      if (first && second) {
        bundle->distances.push_back({*first, *second, distance.distance_m, kDistanceSigmaM});
      }
    }
  }
}

double Calibrator::Apply(const Bundle& bundle, const BundleSummary& summary) {
  for (std::size_t s = 0; s < surveys_.size(); ++s) {
    result_.cameras[s].change += bundle.cameras[s];
    result_.cameras[s].sigma = inflation_ * summary.camera_covariance[s].diagonal().cwiseSqrt();
  }
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (placement_.map_from_base[i]) {
      placement_.map_from_base[i] = bundle.map_from_base[i];
      const Eigen::Vector3d& tilt = bundle.tilts[i];
      frames_[i].mounting_error = {{tilt.x(), tilt.y(), 0.0}, tilt.z()};
    }
    const auto survey = static_cast<std::size_t>(frames_[i].survey);
    const FloorCamera& before = surveys_[survey].survey.camera;
    const FloorCamera after = Adjusted(before, bundle.cameras[survey]);
    for (Keypoint& keypoint : frames_[i].features.keypoints) {
      const Eigen::Vector2d p = after.FloorFromRawPixel(before.RawPixelFromFloor(keypoint.Position()));
      keypoint.x_m = static_cast<float>(p.x());
      keypoint.y_m = static_cast<float>(p.y());
    }
  }
  double moved_px = 0.0;
  for (std::size_t s = 0; s < surveys_.size(); ++s) {
    FloorCamera& camera = surveys_[s].survey.camera;
    const FloorCamera before = camera;
    camera = Adjusted(before, bundle.cameras[s]);
    moved_px = std::max(moved_px, LargestDisplacement(before, camera) / camera.floor.resolution_m);
  }
  return moved_px;
}

// Standard deviation of a floor point's displacement by the camera's unknowns, metres; root mean square of both axes.
double DisplacementSigma(const DerivativeGrid::Jacobian& jacobian, const CameraCovariance& covariance) {
  return std::sqrt(0.5 * (jacobian * covariance * jacobian.transpose()).trace());
}

// Side of a raw pixel on the floor at the centre of the region of interest, metres.
double PixelFootprint(const FloorCamera& camera) {
  const Eigen::Vector2d center = camera.floor.roi.Center();
  const Eigen::Vector2d raw = camera.RawPixelFromFloor(center);
  const Eigen::Vector2d right = camera.FloorFromRawPixel(raw + Eigen::Vector2d(1.0, 0.0)) - center;
  const Eigen::Vector2d down = camera.FloorFromRawPixel(raw + Eigen::Vector2d(0.0, 1.0)) - center;
  return std::sqrt(std::abs(right.x() * down.y() - right.y() * down.x()));
}

// What the calibrated camera is worth: of its corners relative to its centre in the image, and of its centre in the
// base.
FloorCamera WithSigmas(FloorCamera camera, const CameraCovariance& covariance, double unmodelled_px) {
  const DerivativeGrid derivative(camera);
  const RectM& roi = camera.floor.roi;
  const DerivativeGrid::Jacobian center = derivative.At(roi.Center());
  double largest_m = 0.0;
  for (const double x : {roi.x_min, roi.x_max}) {
    for (const double y : {roi.y_min, roi.y_max}) {
      const DerivativeGrid::Jacobian corner = derivative.At({x, y}) - center;
      const double sigma_m = DisplacementSigma(corner, covariance);
      largest_m = std::isfinite(sigma_m) ? std::max(largest_m, sigma_m) : largest_m;
    }
  }
  camera.camera.sigma_px = std::hypot(largest_m / PixelFootprint(camera), unmodelled_px);
  camera.floor.offset_sigma_m = DisplacementSigma(center, covariance);
  return camera;
}

// Moves the keypoints to where the frame's displaced camera saw them.
void CorrectForMounting(const Eigen::Vector3d& camera_center, BuildFrame* frame) {
  const MountingError& error = frame->mounting_error;
  Eigen::Vector4d displaced;
  displaced << error.rotation_rad, error.height_share;
  for (Keypoint& keypoint : frame->features.keypoints) {
    const Eigen::Vector2d p = keypoint.Position();
    const Eigen::Vector2d moved = p + MountingJacobian(camera_center, p) * displaced;
    keypoint.x_m = static_cast<float>(moved.x());
    keypoint.y_m = static_cast<float>(moved.y());
  }
}

void Calibrator::Finish(const BundleSummary& last) {
  for (std::size_t s = 0; s < surveys_.size(); ++s) {
    CalibratedCamera& calibrated = result_.cameras[s];
    CameraCovariance covariance = inflation_ * inflation_ * last.camera_covariance[s];
    for (const CameraUnknown unknown : calibrated.unobserved) {
      const double sigma = kUsualSigma[static_cast<std::size_t>(unknown)];
      covariance(Index(unknown), Index(unknown)) = sigma * sigma;
    }
    FloorCamera& camera = surveys_[s].survey.camera;
    camera = WithSigmas(camera, covariance, options_.unmodelled_px);
    calibrated.camera = camera;
    surveys_[s].rectifier = std::make_shared<Rectifier>(camera, surveys_[s].survey.mask);
  }
  for (BuildFrame& frame : frames_) {
    CorrectForMounting(surveys_[static_cast<std::size_t>(frame.survey)].survey.camera.CameraCenter(), &frame);
  }
}

// Registers linked frames again, since links measured with the old camera are inconsistent with the new one.
void Calibrator::RemeasureLinks() {
  constexpr double kRadiusM = 0.01;
  constexpr double kYawRadiusRad = 0.02;
  std::vector<FramePair> pairs;
  std::vector<RectM> floors;
  for (const BuildFrame& frame : frames_) {
    floors.push_back(surveys_[static_cast<std::size_t>(frame.survey)].survey.camera.floor.roi);
  }
  for (const Link& link : placement_.links) {
    const auto& first = placement_.map_from_base[static_cast<std::size_t>(link.first)];
    const auto& second = placement_.map_from_base[static_cast<std::size_t>(link.second)];
    if (first && second) {
      pairs.push_back({link.first, link.second, first->Between(*second), kRadiusM, kYawRadiusRad});
    }
  }
  placement_.links = RegisterPairs(frames_, floors, pairs, options_.registration);
  const LinkStatistics statistics = MeasureLinks(placement_.links, placement_.map_from_base);
  placement_.rms_m = statistics.rms_m;
  placement_.rms_sigma = statistics.rms_sigma;
}

}  // namespace

void ParseCameraUnknowns(const std::vector<std::string>& names, SelfCalibrationOptions* options) {
  using enum CameraUnknown;
  options->automatic = names == std::vector<std::string>{"auto"};
  options->unknowns.clear();
  if (options->automatic || names == std::vector<std::string>{"none"}) {
    return;
  }
  static const std::map<std::string, std::vector<CameraUnknown>> kNames = {
      {"mounting", {kRoll, kPitch}}, {"height", {kHeight}}, {"focal", {kFocal}}, {"distortion", {kK1, kK2, kP1, kP2}}};
  for (const std::string& name : names) {
    const auto found = kNames.find(name);
    if (found == kNames.end()) {
      throw std::invalid_argument("--self-calibrate: '" + name +
                                  "' is not auto, none, or a list of mounting, height, focal, distortion");
    }
    options->unknowns.insert(options->unknowns.end(), found->second.begin(), found->second.end());
  }
}

void SelfCalibrationOptions::Check() const {
  RequireOption(observations_per_frame >= 1, "observations_per_frame must be at least 1");
  RequireOption(observation_sigma_px > 0.0, "observation_sigma_px must be positive");
  RequireOption(max_scatter_px > 0.0, "max_scatter_px must be positive");
  RequireOption(error_correlation > 0.0, "error_correlation must be positive");
  RequireOption(contradiction_sigmas > 0.0, "contradiction_sigmas must be positive");
  RequireOption(observable_share > 0.0, "observable_share must be positive");
  RequireOption(unmodelled_px >= 0.0, "unmodelled_px must not be negative");
  RequireOption(settled_px > 0.0, "settled_px must be positive");
  RequireOption(tilt_rad >= 0.0, "tilt_rad must not be negative");
  RequireOption(tilt_height >= 0.0, "tilt_height must not be negative");
  registration.Check();
}

CalibratedFrames SelfCalibrate(FrameSet set, Placement placement, const SelfCalibrationOptions& options) {
  options.Check();
  CalibratedFrames result{std::move(set), std::move(placement), {}};
  if (options.automatic || !options.unknowns.empty()) {
    result.calibration = Calibrator(&result, options).Run();
  }
  return result;
}

}  // namespace floorloc
