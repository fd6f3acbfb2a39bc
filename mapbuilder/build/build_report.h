// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/geometry/pose2.h"
#include "core/map/floor_map.h"
#include "mapbuilder/build/map_scale.h"
#include "mapbuilder/heights/frame_heights.h"
#include "mapbuilder/markers/markers.h"
#include "mapbuilder/screening/auto_mask.h"
#include "mapbuilder/self_calibration/camera_doubt.h"
#include "mapbuilder/self_calibration/self_calibration.h"
#include "mapbuilder/survey/dropped_frame.h"

namespace floorloc {

/// A survey frame that was localized in a map built without it.
struct HeldOutFrame {
  std::string filename;
  Pose2 map_from_base;   ///< pose found by the build
  std::string status;    ///< "localized", "wrong", "ambiguous" or "not_localized"
  std::string reason;    ///< only if "not_localized"
  double error_m = 0.0;  ///< at the centre of its view; only if "localized" or "wrong"
  double error_rad = 0.0;
  int keypoints = 0;
  int inliers = 0;
};

/// A surveyed floor point and where the map puts it according to one frame.
struct ControlPointError {
  std::string filename;
  Eigen::Vector2d surveyed_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d observed_m = Eigen::Vector2d::Zero();  ///< according to the frame's pose
  double sigma_m = 1e-3;                                 ///< of the surveyed coordinates, as given
};

/// Vignetting: how brightness falls off towards the corners of a survey's images.
struct FlatField {
  int columns = 0, rows = 0;
  std::vector<double> gain;  ///< row-major from the top of the rectified image; 1 at the centre
};

/// Result of a build.
struct BuildReport {
  int frames = 0;
  int frames_used = 0;
  std::vector<DroppedFrame> dropped;
  std::vector<std::string> warnings;     ///< one sentence each
  std::vector<CameraMaskFinding> masks;  ///< per survey; read from a map they have no `mask`
  std::vector<MarkerFit> markers;        ///< detected ones
  std::vector<int> part_sizes;           ///< largest first; more than one: the survey has gaps
  bool kept_all = false;                 ///< all parts are in the map, also those without links to the largest
  bool repeats_unaided = false;          ///< see Placement
  int links = 0;
  int rejected_links = 0;
  int overlapping_pairs = 0;
  int unmatched_pairs = 0;  ///< overlapping pairs whose images do not match
  double link_rms_m = 0.0;
  double link_rms_sigma = 0.0;
  double drift_m = 0.0;
  double drift_rad = 0.0;
  FrameHeights heights;
  SelfCalibration self_calibration;
  CameraDoubt camera_doubt;  ///< of cameras that were not calibrated by all that the images tell
  MapScale scale;
  std::vector<DistanceMisfit> distances;  ///< those that were used
  double area_m2 = 0.0;
  RectM extent;
  int keypoints = 0;
  double mean_observations = 0.0;
  std::vector<MapLattice> lattices;  ///< where the floor repeats itself; the map has them in a table of its own
  std::vector<HeldOutFrame> held_out;
  std::vector<ControlPointError> control_points;  ///< those that were used
  double control_point_scale = 1.0;    ///< their distances over those in the images, where it explains a misfit
  std::vector<FlatField> flat_fields;  ///< per survey
  std::string content_version;
  std::string extends;                                  ///< file name of the map that was extended; empty: none
  int frames_found = 0;                                 ///< new frames that were localized in that map
  int resumed_frames = 0;                               ///< frames whose features were restored from the journal
  std::vector<std::pair<std::string, double>> stage_s;  ///< stage, seconds
  double total_s = 0.0;
};

/// The report as JSON, for `--json` and the map's report_json. The latter omits times, so that equal input gives equal
/// files, and what the map holds elsewhere.
std::string ToJson(const BuildReport& report, bool with_times);

/// Inverse of ToJson as the map has it, except for the self-calibration. Fields that an older builder did not write
/// keep their defaults. Throws MapError when the text is damaged.
BuildReport ParseBuildReport(const std::string& text);

/// What moves with the camera and was not masked, one sentence per survey.
std::vector<std::string> MaskWarnings(const BuildReport& report);

/// What to check before using the map, one sentence each: those, the report's warnings and those derived from its
/// numbers.
std::vector<std::string> AllWarnings(const BuildReport& report);

/// Human-readable summary.
std::string ToText(const BuildReport& report);

}  // namespace floorloc
