// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "mapbuilder/markers/marker_detection.h"
#include "mapbuilder/placement/place_frames.h"

namespace floorloc {

struct MarkerOptions {
  std::filesystem::path file;  ///< CSV of known markers; empty: no markers are detected
  MarkerDetectionOptions detection;
  double margin_m = -1.0;  ///< printed paper around a marker's black square; negative: a quarter of its size

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Fit of a detected marker to the finished map.
struct MarkerFit {
  int id = 0;
  bool known = false;    ///< listed in the file
  bool used = false;     ///< known and consistent with the others
  int frames = 0;        ///< frames that detected it
  double error_m = 0.0;  ///< distance from its surveyed position; 0 when unknown
};

/// Detected markers of a build: the constraints they give to the map, and the image areas that they cover.
class MarkerSurvey {
 public:
  /// Reads the file and detects markers in all frames. Throws InputError when the file is invalid, when none of its
  /// markers is detected, when they do not determine position and heading of the map, or when their size differs.
  MarkerSurvey(const MarkerOptions& options, const FrameSet& set);

  /// Removes keypoints on markers that were detected in the frame.
  FrameSet MaskDetected(FrameSet set) const;

  /// Adds the known markers to the surveys' control points: their centres, or all corners where the yaw is known.
  /// Replaces those of an earlier call.
  FrameSet AddControlPoints(FrameSet set) const;

  /// Compares the markers' map positions with the file (least median of squares over pairs of markers, then residuals).
  /// Markers that contradict the others are excluded with a warning. Throws InputError when all yaws are off by the
  /// same quarter turn, or too few markers agree. Returns true when there is one: then add the control points and place
  /// the frames again.
  bool ExcludeContradicting(const std::vector<BuildFrame>& frames, const Placement& placement);

  /// Moves the detections to where cameras at so many times their height see them.
  void MultiplyHeights(double factor, const FrameSet& set);

  /// Removes keypoints on all markers in the map, also in frames that show a marker only partly.
  FrameSet MaskInMap(const Placement& placement, FrameSet set) const;

  /// Fit of each detected marker to the finished map.
  std::vector<MarkerFit> Fits(const std::vector<BuildFrame>& frames, const Placement& placement) const;

  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  const KnownMarker* Find(int id) const;
  void CheckSizes();
  void CheckKnownMarkers();
  void CheckYawDefinition(const std::vector<double>& yaw_errors_rad) const;

  MarkerOptions options_;
  std::vector<KnownMarker> known_;
  std::vector<MarkerDetection> detections_;
  std::vector<std::size_t> survey_control_points_;  // control points of each survey that are not from markers
  std::set<int> excluded_;
  std::vector<std::string> warnings_;
};

}  // namespace floorloc
