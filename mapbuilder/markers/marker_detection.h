// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

struct MarkerDetectionOptions {
  std::string dictionary = "DICT_4X4_50";  ///< a name of ArucoDictionaryNames()
  double size_m = 0.0;                     ///< side of the black square, metres
  RunOptions run;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Detection of a marker in one frame.
struct MarkerDetection {
  int frame = 0;
  int id = 0;
  /// Base frame, metres: clockwise, starting at the upper left corner of the upright marker, as published.
  std::array<Eigen::Vector2d, 4> corners_m;

  Eigen::Vector2d Center() const { return 0.25 * (corners_m[0] + corners_m[1] + corners_m[2] + corners_m[3]); }
  double MeanSideM() const;
  /// True when all sides have equal length within the relative `tolerance`.
  bool IsSquare(double tolerance) const;
};

/// Detects markers in the frames' images, which are read again so that builds without markers have no cost. Ordered by
/// frame; unreadable images give no detections.
std::vector<MarkerDetection> DetectMarkers(const std::vector<BuildFrame>& frames,
                                           const std::vector<LoadedSurvey>& surveys,
                                           const MarkerDetectionOptions& options);

}  // namespace floorloc
