// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/self_calibration/self_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "core/geometry/mounting.h"
#include "core/map/camera_correction.h"
#include "mapbuilder/self_calibration/bundle_input.h"
#include "mapbuilder/self_calibration/calibration_unknowns.h"
#include "mapbuilder/self_calibration/camera_worth.h"
#include "mapbuilder/self_calibration/link_sigmas.h"

namespace floorloc {
namespace {

// A round of the calibration. Before the camera is calibrated, views of one floor point scatter more, and a share of
// the observations is enough.
struct Round {
  double track_radius_factor;
  double observation_share;
};
constexpr std::array<Round, 4> kRounds = {{{2.5, 0.4}, {1.0, 1.0}, {1.0, 1.0}, {1.0, 1.0}}};

class Calibrator {
 public:
  // Calibrates the result's frames, surveys and placement in place.
  Calibrator(CalibratedFrames* result, const SelfCalibrationOptions& options)
      : set_(result->set),
        frames_(set_.frames),
        surveys_(set_.surveys),
        placement_(result->placement),
        options_(options),
        priors_(ChooseCameraPriors(set_, options)) {}

  SelfCalibration Run();

 private:
  // What Apply() changes.
  struct Original {
    std::vector<FloorCamera> cameras;
    std::vector<std::vector<Keypoint>> keypoints;
    std::vector<std::optional<Pose2>> map_from_base;
  };

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
  // Returns by how many pixels of the rectified image the calibration moved the floor at most.
  double Apply(const Bundle& bundle, const BundleSummary& summary);
  void Finish(const BundleSummary& last);
  void RemeasureLinks();

  FrameSet& set_;
  std::vector<BuildFrame>& frames_;
  std::vector<LoadedSurvey>& surveys_;
  Placement& placement_;
  const SelfCalibrationOptions& options_;
  std::vector<CameraPriors> priors_;  // one per survey; 0: held constant
  double inflation_ = 1.0;            // of standard deviations, since the observations' errors are correlated
  SelfCalibration result_;
};

SelfCalibration Calibrator::Run() {
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
  bundle.cameras.assign(surveys_.size(), CameraAdjustment::Zero());
  bundle.tilts.assign(frames_.size(), Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    bundle.map_from_base.push_back(placement_.map_from_base[i].value_or(Pose2()));
    bundle.camera_of_frame.push_back(frames_[i].survey);
  }
  for (const CalibratedCamera& camera : result_.cameras) {
    bundle.earlier_change.push_back(camera.change);
  }
  const bool own_heights =
      std::any_of(frames_.begin(), frames_.end(), [](const BuildFrame& frame) { return frame.height_ratio != 1.0; });
  bundle.prior = {priors_, options_.tilt_rad, own_heights ? options_.own_height : options_.tilt_height};
  for (CameraPriors& priors : bundle.prior.cameras) {
    // Instead of less weight for the observations, whose loss is robust at their own scatter.
    std::transform(priors.begin(), priors.end(), priors.begin(), [&](double sigma) { return sigma / inflation_; });
  }
  bundle.observation_sigma_m = options_.observation_sigma_px * surveys_.front().survey.camera.floor.resolution_m;
  const BundleInput input(set_, placement_.map_from_base);
  AddTracks(input,
            {round.track_radius_factor,
             static_cast<int>(std::ceil(round.observation_share * options_.observations_per_frame))},
            &bundle);
  AddAbsoluteConstraints(input, options_.distance_sigma_m, &bundle);
  if (bundle.priors.empty() && bundle.control_points.empty()) {
    const auto first = std::find_if(placement_.map_from_base.begin(), placement_.map_from_base.end(),
                                    [](const auto& pose) { return pose.has_value(); });
    bundle.fixed = {static_cast<int>(first - placement_.map_from_base.begin())};
  }
  return bundle;
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
    const FloorCamera before = CameraOf(frames_[i], surveys_);
    const FloorCamera after =
        Adjusted(surveys_[survey].survey.camera, bundle.cameras[survey]).AtHeight(frames_[i].height_ratio);
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
      covariance(static_cast<int>(unknown), static_cast<int>(unknown)) = sigma * sigma;
    }
    FloorCamera& camera = surveys_[s].survey.camera;
    camera = WithSigmas(camera, covariance, options_.unmodelled_px);
    calibrated.camera = camera;
    surveys_[s].rectifier = std::make_shared<Rectifier>(camera, surveys_[s].survey.mask);
  }
  for (BuildFrame& frame : frames_) {
    CorrectForMounting(CameraOf(frame, surveys_).CameraCenter(), &frame);
  }
}

// Registers linked frames again, since links measured with the old camera are inconsistent with the new one.
void Calibrator::RemeasureLinks() {
  constexpr double kRadiusM = 0.01;
  constexpr double kYawRadiusRad = 0.02;
  std::vector<FramePair> pairs;
  for (const Link& link : placement_.links) {
    const auto& first = placement_.map_from_base[static_cast<std::size_t>(link.first)];
    const auto& second = placement_.map_from_base[static_cast<std::size_t>(link.second)];
    if (first && second) {
      pairs.push_back({link.first, link.second, first->Between(*second), kRadiusM, kYawRadiusRad});
    }
  }
  placement_.links = RegisterPairs(frames_, set_.FloorsInBase(), pairs, options_.registration);
  RescaleSigmas(placement_.map_from_base, options_.link_sigmas, &placement_.links);
  const LinkStatistics statistics = MeasureLinks(placement_.links, placement_.map_from_base);
  placement_.rms_m = statistics.rms_m;
  placement_.rms_sigma = statistics.rms_sigma;
}

}  // namespace

CalibratedFrames SelfCalibrate(FrameSet set, Placement placement, const SelfCalibrationOptions& options) {
  options.Check();
  CalibratedFrames result{std::move(set), std::move(placement), {}};
  if (options.automatic || !options.unknowns.empty()) {
    result.calibration = Calibrator(&result, options).Run();
  }
  return result;
}

}  // namespace floorloc
