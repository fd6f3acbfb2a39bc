// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "core/io/survey.h"
#include "core/localization/moving_frame.h"
#include "mapbuilder/batch/run_options.h"

namespace floorloc {

enum class PriorSource {
  kNone,      ///< global search for every frame
  kOdometry,  ///< last fix propagated by odometry; global search before the first fix and after a loss
  kTruth,     ///< groundtruth.tum, transformed into the map frame by globally localizing a few frames
};

/// Throws std::invalid_argument that lists the known names.
PriorSource ParsePriorSource(const std::string& name);

struct LocalizeFramesOptions {
  PriorSource prior = PriorSource::kNone;
  double prior_radius_m = 0.25;
  double prior_yaw_radius_rad = 0.26;
  bool correct_camera = true;    ///< by the map's self-calibration, if the camera is that of one of its surveys
  RunOptions run{.threads = 1};  ///< not used with PriorSource::kOdometry

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Localization result of one frame.
struct LocalizedFrame {
  SurveyFrame frame;
  LocalizationResult result;
  double decode_ms = 0.0;
};

/// The survey's own mask, or what the map has of its camera; empty: none.
cv::Mat MaskIn(const MapInfo& info, const Survey& survey);

/// Reads and localizes localized->frame; sets localized->result and decode_ms. hints: without the JPEG's quality.
/// Returns what was observed. Throws InputError.
FrameObservation LocateFrame(const Localizer& localizer, const Rectifier& rectifier, const Survey& survey,
                             FrameHints hints, LocalizedFrame* localized);

/// Localizes every frame of a survey folder, in order. Throws InputError.
std::vector<LocalizedFrame> LocalizeFrames(const Localizer& localizer, const Survey& survey,
                                           const LocalizeFramesOptions& options);

/// One line of the --results file.
std::string ToJsonLine(const LocalizedFrame& localized);

/// The localized frames as a trajectory.
Trajectory ToTrajectory(const std::vector<LocalizedFrame>& frames);

}  // namespace floorloc
