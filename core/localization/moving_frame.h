// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "core/geometry/readout.h"
#include "core/localization/localizer.h"

namespace floorloc {

/// How the robot moves while an image is exposed, and what is known of its camera's read-out.
struct FrameMotion {
  std::optional<Eigen::Vector3d> twist = {};      ///< (vx, vy, omega) of the base, m/s and rad/s; empty: unknown
  std::optional<ReadoutMeasurement> learnt = {};  ///< by earlier images, of a camera that does not tell its read-out
};

/// What is known before an image is localized.
struct FrameHints {
  std::optional<PosePrior> prior = {};
  std::optional<CameraPrior> camera = {};  ///< of the camera's errors
  FrameMotion motion = {};
  cv::Mat left_out = {};                 ///< as in Localizer::Observe
  std::optional<int> jpeg_quality = {};  ///< EstimateJpegQuality() of the image's file
  bool anywhere = true;                  ///< search the whole map when the frame is not localized near the prior
};

struct ObservedFrame {
  FrameObservation observation;
  LocalizationResult result;  ///< its covariance holds what rows that may not be where they belong do to the pose
};

/// Rectifies and localizes an image whose rows are put where they belong. A read-out that is unknown is measured from
/// the image itself (LocalizationResult::readout), and the image localized once more with it where that moves the pose
/// by more than ReadoutFitOptions::max_error_m. raw: as in Localizer::Observe.
ObservedFrame ObserveAndLocalize(const Localizer& localizer, const Rectifier& rectifier, const cv::Mat& raw,
                                 const FrameHints& hints);

}  // namespace floorloc
