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
};

/// A marker in a finished map.
struct MarkerFit {
  int id = 0;
  bool known = false;    ///< listed in the file
  bool used = false;     ///< known, and not in contradiction to the others
  int frames = 0;        ///< that saw it
  double error_m = 0.0;  ///< of its place in the map, for a known one
};

/// The markers of one build: the constraints they give to the map, and the parts of the images they cover.
class MarkerSurvey {
 public:
  /// Reads the file and finds the markers in all frames. Throws InputError when the file is wrong, when none of its
  /// markers is seen, when they do not fix the map's place and heading, or when they are of another size.
  MarkerSurvey(const MarkerOptions& options, const FrameSet& set);

  /// The frames without the keypoints on markers that a frame sees whole.
  FrameSet MaskDetected(FrameSet set) const;

  /// The surveys with the known markers among their control points: their centres, or all corners where the yaw is
  /// known. Those of an earlier call are replaced.
  FrameSet AddControlPoints(FrameSet set) const;

  /// Compares the markers' places in the map with the file (least median of squares over all pairs of markers, then
  /// residuals). A marker that contradicts the others is named in a warning, and not used any more: true when there is
  /// one; the control points have to be added and the frames placed again.
  bool ExcludeContradicting(const std::vector<BuildFrame>& frames, const Placement& placement);

  /// The frames without the keypoints on markers, those that see a marker in part included.
  FrameSet MaskInMap(const Placement& placement, FrameSet set) const;

  /// How well each marker that was seen fits the finished map.
  std::vector<MarkerFit> Fits(const std::vector<BuildFrame>& frames, const Placement& placement) const;

  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  const KnownMarker* Find(int id) const;
  void CheckSizes();
  void CheckKnownMarkers();

  MarkerOptions options_;
  std::vector<KnownMarker> known_;
  std::vector<MarkerDetection> detections_;
  std::vector<std::size_t> survey_control_points_;  // number of control points of each survey that came with it
  std::set<int> excluded_;
  std::vector<std::string> warnings_;
};

}  // namespace floorloc
