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
#include "mapbuilder/keypoints/keypoint_tracks.h"

namespace floorloc {
namespace {

// Prior standard deviations of calibration errors: roll, pitch, height, focal length, k1, k2, p1, p2.
constexpr std::array<double, kCameraUnknowns> kPriorSigma = {0.03, 0.03, 0.05, 0.03, 0.1, 0.1, 0.005, 0.005};

// A round of the calibration. Before the camera is calibrated, views of one floor point scatter more, and a share of
// the observations is enough.
struct Round {
  double track_radius_factor;
  double observation_share;
};
constexpr std::array<Round, 4> kRounds = {{{2.5, 0.4}, {1.0, 1.0}, {1.0, 1.0}, {1.0, 1.0}}};

constexpr double kDistanceSigmaM = 1e-3;

using Jacobian = Eigen::Matrix<double, 2, kCameraUnknowns>;

// Derivative of the floor points with respect to the camera, interpolated between the nodes of a grid over the region
// of interest: it is smooth, and exact values cost sixteen inversions of the lens model.
class DerivativeGrid {
 public:
  explicit DerivativeGrid(const FloorCamera& camera) : camera_(camera), derivative_(camera) {
    const RectM& roi = camera.floor.roi;
    for (int row = 0; row <= kIntervals; ++row) {
      for (int column = 0; column <= kIntervals; ++column) {
        nodes_.push_back(
            Exact({roi.x_min + roi.width_m() * column / kIntervals, roi.y_min + roi.height_m() * row / kIntervals}));
      }
    }
  }

  Jacobian At(const Eigen::Vector2d& point_in_base) const {
    const RectM& roi = camera_.floor.roi;
    if (!roi.Contains(point_in_base)) {
      return Exact(point_in_base);
    }
    const double u = kIntervals * (point_in_base.x() - roi.x_min) / roi.width_m();
    const double v = kIntervals * (point_in_base.y() - roi.y_min) / roi.height_m();
    const int column = std::min(static_cast<int>(u), kIntervals - 1);
    const int row = std::min(static_cast<int>(v), kIntervals - 1);
    const double a = u - column, b = v - row;
    return (1.0 - b) * ((1.0 - a) * Node(row, column) + a * Node(row, column + 1)) +
           b * ((1.0 - a) * Node(row + 1, column) + a * Node(row + 1, column + 1));
  }

 private:
  static constexpr int kIntervals = 32;

  Jacobian Exact(const Eigen::Vector2d& point_in_base) const {
    return derivative_.At(camera_.RawPixelFromFloor(point_in_base));
  }
  const Jacobian& Node(int row, int column) const {
    return nodes_[static_cast<std::size_t>(row * (kIntervals + 1) + column)];
  }

  FloorCamera camera_;
  AdjustmentDerivative derivative_;
  std::vector<Jacobian> nodes_;
};

// Builds the observations of one survey's camera.
class ObservationBuilder {
 public:
  explicit ObservationBuilder(const FloorCamera& camera)
      : camera_(camera), derivative_(camera), center_(camera.CameraCenter()) {}

  Observation Make(int frame, const Eigen::Vector2d& point_in_base) const {
    Observation observation;
    observation.frame = frame;
    observation.point_in_base_m = point_in_base;
    observation.by_camera = derivative_.At(point_in_base);
    const Eigen::Matrix<double, 2, 4> mounting = MountingJacobian(center_, point_in_base);
    observation.by_tilt << mounting.col(0), mounting.col(1), mounting.col(3);
    return observation;
  }
  const FloorCamera& camera() const { return camera_; }

 private:
  FloorCamera camera_;
  DerivativeGrid derivative_;
  Eigen::Vector3d center_;
};

class Calibrator {
 public:
  // Calibrates the result's frames, surveys and placement in place.
  Calibrator(CalibratedFrames* result, const SelfCalibrationOptions& options)
      : frames_(result->set.frames), surveys_(result->set.surveys), placement_(result->placement), options_(options) {}

  SelfCalibration Run() {
    RequireScale();
    SelfCalibration result;
    result.cameras.resize(surveys_.size());
    for (std::size_t round = 0; round < kRounds.size(); ++round) {
      Bundle bundle = MakeBundle(kRounds[round]);
      for (const CalibratedCamera& camera : result.cameras) {
        bundle.earlier_change.push_back(camera.change);
      }
      const BundleSummary summary = AdjustBundle(&bundle);
      if (round == 0) {
        result.rms_before_m = summary.rms_before_m;
      }
      result.rms_after_m = summary.rms_after_m;
      result.tracks = static_cast<int>(bundle.tracks.size());
      const double moved_px = Apply(bundle, summary, &result);
      if (round > 0 && moved_px < options_.settled_px) {
        break;
      }
    }
    for (std::size_t s = 0; s < surveys_.size(); ++s) {
      result.cameras[s].camera = surveys_[s].survey.camera;
      surveys_[s].rectifier = std::make_shared<Rectifier>(surveys_[s].survey.camera, surveys_[s].survey.mask);
    }
    RemeasureLinks();
    return result;
  }

 private:
  void RequireScale() const;
  bool HasScaleConstraint() const;
  Bundle MakeBundle(const Round& round);
  void ChooseTracks(const Round& round, const std::vector<ObservationBuilder>& builders, Bundle* bundle) const;
  void AddAbsoluteConstraints(const std::vector<ObservationBuilder>& builders, Bundle* bundle) const;
  // Returns by how many pixels of the rectified image the calibration moved the floor at most.
  double Apply(const Bundle& bundle, const BundleSummary& summary, SelfCalibration* result);
  void RemeasureLinks();

  std::vector<BuildFrame>& frames_;
  std::vector<LoadedSurvey>& surveys_;
  Placement& placement_;
  const SelfCalibrationOptions& options_;
};

bool Calibrator::HasScaleConstraint() const {
  const bool poses =
      std::any_of(frames_.begin(), frames_.end(), [](const BuildFrame& frame) { return frame.prior.has_value(); });
  const auto fixes_scale = [](const LoadedSurvey& loaded) {
    return loaded.survey.control_points.size() > 1 || !loaded.survey.known_distances.empty();
  };
  return poses || std::any_of(surveys_.begin(), surveys_.end(), fixes_scale);
}

void Calibrator::RequireScale() const {
  const auto asked = [&](CameraUnknown unknown) {
    return std::find(options_.unknowns.begin(), options_.unknowns.end(), unknown) != options_.unknowns.end();
  };
  if ((asked(CameraUnknown::kHeight) || asked(CameraUnknown::kFocal)) && !HasScaleConstraint()) {
    throw InputError(
        "height and focal length are not observable from images alone; add control_points.csv, known_distances.csv, "
        "--markers or --poses, or leave them out of --self-calibrate");
  }
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
  for (const CameraUnknown unknown : options_.unknowns) {
    const auto i = static_cast<std::size_t>(unknown);
    bundle.prior.camera[i] = kPriorSigma[i];
  }
  bundle.prior.tilt_rad = options_.tilt_rad;
  bundle.prior.tilt_height = options_.tilt_height;
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

// Largest displacement of floor points at the region of interest's corners and centre, metres.
double Displacement(const FloorCamera& before, const FloorCamera& after) {
  const RectM& roi = before.floor.roi;
  const Eigen::Vector2d middle = roi.Center();
  double largest_m = 0.0;
  for (const double x : {roi.x_min, middle.x(), roi.x_max}) {
    for (const double y : {roi.y_min, middle.y(), roi.y_max}) {
      const Eigen::Vector2d p(x, y);
      const double moved_m = (after.FloorFromRawPixel(before.RawPixelFromFloor(p)) - p).norm();
      largest_m = std::isfinite(moved_m) ? std::max(largest_m, moved_m) : largest_m;
    }
  }
  return largest_m;
}

double Calibrator::Apply(const Bundle& bundle, const BundleSummary& summary, SelfCalibration* result) {
  for (std::size_t s = 0; s < surveys_.size(); ++s) {
    result->cameras[s].change += bundle.cameras[s];
    result->cameras[s].sigma = summary.camera_sigma[s];
  }
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (placement_.map_from_base[i]) {
      placement_.map_from_base[i] = bundle.map_from_base[i];
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
    moved_px = std::max(moved_px, Displacement(before, camera) / camera.floor.resolution_m);
  }
  return moved_px;
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

std::vector<CameraUnknown> ParseCameraUnknowns(const std::vector<std::string>& names) {
  std::vector<CameraUnknown> unknowns;
  for (const std::string& name : names) {
    if (name == "mounting") {
      unknowns.insert(unknowns.end(), {CameraUnknown::kRoll, CameraUnknown::kPitch});
    } else if (name == "height") {
      unknowns.push_back(CameraUnknown::kHeight);
    } else if (name == "focal") {
      unknowns.push_back(CameraUnknown::kFocal);
    } else if (name == "distortion") {
      unknowns.insert(unknowns.end(), {CameraUnknown::kK1, CameraUnknown::kK2, CameraUnknown::kP1, CameraUnknown::kP2});
    } else {
      throw std::invalid_argument("unknown '" + name + "' (mounting, height, focal, distortion)");
    }
  }
  return unknowns;
}

void SelfCalibrationOptions::Check() const {
  RequireOption(observations_per_frame >= 1, "observations_per_frame must be at least 1");
  RequireOption(settled_px > 0.0, "settled_px must be positive");
  RequireOption(tilt_rad >= 0.0, "tilt_rad must not be negative");
  RequireOption(tilt_height >= 0.0, "tilt_height must not be negative");
  registration.Check();
}

CalibratedFrames SelfCalibrate(FrameSet set, Placement placement, const SelfCalibrationOptions& options) {
  options.Check();
  CalibratedFrames result{std::move(set), std::move(placement), {}};
  if (!options.unknowns.empty()) {
    result.calibration = Calibrator(&result, options).Run();
  }
  return result;
}

}  // namespace floorloc
