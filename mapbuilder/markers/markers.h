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
  std::filesystem::path file;  ///< CSV of known markers; empty: no markers are sought
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

/// The markers of one build: what of the map they fix, and what of the pictures they hide.
class MarkerSurvey {
 public:
  /// Reads the file and finds the markers in all frames. Throws InputError when the file is wrong, when none of its
  /// markers is seen, when they do not fix the map's place and heading, or when they are of another size.
  MarkerSurvey(const MarkerOptions& options, const std::vector<LoadedSurvey>& surveys,
               const std::vector<BuildFrame>& frames);

  /// Takes the keypoints on markers out of the frames that see the markers whole.
  void MaskSeen(std::vector<BuildFrame>* frames) const;

  /// Adds the known markers to the control points of the surveys: their centres, or all corners where the yaw is known.
  void AddControlPoints(const std::vector<BuildFrame>& frames, std::vector<LoadedSurvey>* surveys) const;

  /// Compares the markers' places in the map with the file (least median of squares over all pairs of markers, then
  /// residuals). A marker that contradicts the others is named in a warning, and not used any more: true when there is
  /// one, whose control points are gone and the frames to be placed again.
  bool LeaveOutContradicting(const std::vector<BuildFrame>& frames, const Placement& placement,
                             std::vector<LoadedSurvey>* surveys);

  /// Takes the keypoints on markers out of all frames, those that see a marker in part included.
  void MaskInMap(const Placement& placement, std::vector<BuildFrame>* frames) const;

  /// How well each marker that was seen fits the finished map.
  std::vector<MarkerFit> Fits(const std::vector<BuildFrame>& frames, const Placement& placement) const;

  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  const KnownMarker* Find(int id) const;
  void CheckSizes();
  void CheckKnown();

  MarkerOptions options_;
  std::vector<KnownMarker> known_;
  std::vector<MarkerSighting> sightings_;
  std::vector<std::size_t> own_control_points_;  // number of control points of each survey that came with it
  std::set<int> left_out_;
  std::vector<std::string> warnings_;
};

}  // namespace floorloc
