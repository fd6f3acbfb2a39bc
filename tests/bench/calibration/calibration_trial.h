// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/localization/localizer_options.h"
#include "mapbuilder/build/build_options.h"
#include "tests/bench/calibration/calibration_case.h"

namespace floorloc {

/// Recordings whose images are made once; a case changes the calibration beside them only.
struct CalibrationScene {
  std::filesystem::path folder;
  std::vector<std::string> groups;  ///< of frames to localize

  std::filesystem::path Survey() const { return folder / "survey"; }
  std::filesystem::path Group(const std::string& name) const { return folder / name; }
};

/// Simulates the survey and `frames` frames of each group, unless they exist. photograph: image of a floor from which
/// the floor is quilted.
CalibrationScene MakeCalibrationScene(const std::filesystem::path& folder, const std::string& photograph, int frames);

/// Errors of a method over a group, after the frame offset that no image can tell.
struct CalibrationScore {
  int frames = 0;
  int localized = 0;
  double median_m = 0.0;
  double p95_m = 0.0;
  double mean_nees = 0.0;  ///< of (x, y, yaw): 3 when the covariance is consistent; NaN for a method without one
};

struct CalibrationRow {
  std::string group;
  CalibrationScore floorloc;
  CalibrationScore sift;
};

struct CalibrationResult {
  double map_rms_m = 0.0;  ///< of the survey's poses
  double build_s = 0.0;
  std::vector<CalibrationRow> rows;
};

struct TrialOptions {
  BuildOptions build;  ///< surveys are filled in
  LocalizerOptions localizer;
  bool learn = false;  ///< also localize as a vehicle that learns its camera; its row has the second half of a group
};

/// Builds the map of a recorded survey with ground truth and localizes the frames of recorded folders.
CalibrationResult RunRecorded(const std::filesystem::path& survey, const std::vector<std::filesystem::path>& groups,
                              const TrialOptions& trial);

/// The same with the case's calibrations of the scene. The map is made in the scene's folder.
CalibrationResult RunCase(const CalibrationScene& scene, const CalibrationCase& test, TrialOptions trial);

}  // namespace floorloc
