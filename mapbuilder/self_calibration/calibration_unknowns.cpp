// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/self_calibration/calibration_unknowns.h"

#include <algorithm>

#include "core/io/input_error.h"

namespace floorloc {
namespace {

// Prior standard deviations of calibration errors when the user asks for them: roll, pitch, height, focal length, k1,
// k2, p1, p2.
constexpr CameraPriors kPriorSigma = {0.03, 0.03, 0.05, 0.03, 0.1, 0.1, 0.005, 0.005};

bool IsTangential(int unknown) {
  return unknown == static_cast<int>(CameraUnknown::kP1) || unknown == static_cast<int>(CameraUnknown::kP2);
}

// Control points, known distances or poses.
bool HasScaleConstraint(const FrameSet& set) {
  const bool poses = std::any_of(set.frames.begin(), set.frames.end(),
                                 [](const BuildFrame& frame) { return frame.prior.has_value(); });
  const auto fixes_scale = [](const LoadedSurvey& loaded) {
    return loaded.survey.control_points.size() > 1 || !loaded.survey.known_distances.empty();
  };
  return poses || std::any_of(set.surveys.begin(), set.surveys.end(), fixes_scale);
}

}  // namespace

std::vector<CameraPriors> ChooseCameraPriors(const FrameSet& set, const SelfCalibrationOptions& options) {
  using enum CameraUnknown;
  const bool scale = HasScaleConstraint(set);
  std::vector<CameraUnknown> unknowns = options.unknowns;
  if (options.automatic) {
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
  std::vector<CameraPriors> all;
  for (const LoadedSurvey& loaded : set.surveys) {
    CameraPriors priors{};
    for (const CameraUnknown unknown : unknowns) {
      const int i = static_cast<int>(unknown);
      const bool exists =
          !IsTangential(i) || loaded.survey.camera.camera.distortion_model != DistortionModel::kEquidistant;
      const CameraPriors& sigma = options.automatic ? kUsualSigma : kPriorSigma;
      priors[static_cast<std::size_t>(i)] = exists ? sigma[static_cast<std::size_t>(i)] : 0.0;
    }
    all.push_back(priors);
  }
  return all;
}

}  // namespace floorloc
