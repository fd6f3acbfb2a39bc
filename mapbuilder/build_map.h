// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/io/trajectory.h"
#include "core/vision/feature_extractor.h"
#include "mapbuilder/fuse_keypoints.h"
#include "mapbuilder/markers.h"
#include "mapbuilder/mosaic.h"
#include "mapbuilder/place_frames.h"
#include "mapbuilder/progress.h"
#include "mapbuilder/self_calibration.h"

namespace floorloc {

struct BuildOptions {
  std::vector<std::filesystem::path> surveys;
  std::filesystem::path out;
  std::filesystem::path extend;  ///< the map to which the surveys are added, in its frame; may be `out`; empty: none
  ExtractorOptions extractor;    ///< not used with `extend`: the map's own
  Trajectory poses;              ///< map_from_base known from another system; may be empty
  MarkerOptions markers;
  PlacementOptions placement;
  SelfCalibrationOptions self_calibration;
  FusionOptions fusion;
  double max_keypoints_per_m2 = 0.0;  ///< budget of the map; 0: what suits the camera
  MosaicOptions mosaic;               ///< resolution_m 0: the surveys'
  int threads = 0;                    ///< 0: one per core
  std::uint32_t seed = 1;
  bool resume = false;  ///< use what an earlier run left in the journal beside `out`
  /// Names all options, as the caller has them: what a journal holds of a build with others is not used.
  std::string fingerprint;
  ProgressOutput progress;
};

/// What a build did.
struct BuildReport {
  int frames = 0;
  int frames_used = 0;
  std::vector<std::pair<std::string, std::string>> dropped;  ///< file name, reason
  std::vector<std::string> warnings;                         ///< sentences about what is not as it should be
  std::vector<MarkerFit> markers;                            ///< that were seen
  std::vector<int> part_sizes;                               ///< largest first; more than one: the survey has gaps
  bool kept_all = false;                                     ///< all parts are in the map
  int links = 0;
  int rejected_links = 0;
  int overlapping_pairs = 0;
  int unmatched_pairs = 0;  ///< of the overlapping ones
  double link_rms_m = 0.0;
  double link_rms_sigma = 0.0;
  double drift_m = 0.0;
  double drift_rad = 0.0;
  SelfCalibration self_calibration;
  double area_m2 = 0.0;
  RectM extent;
  int keypoints = 0;
  double mean_observations = 0.0;
  std::string content_version;
  std::string extends;                                  ///< file name of the map that was extended; empty: none
  int frames_found = 0;                                 ///< of the new ones, in that map
  int resumed_frames = 0;                               ///< whose features an earlier run had found
  std::vector<std::pair<std::string, double>> stage_s;  ///< stage, seconds
  double total_s = 0.0;
};

/// Surveys -> map file. With `extend` the frames and the frame of that map stay as they are; the report's frames and
/// links are the new ones, its floor and keypoints those of the whole map. Throws InputError or MapError; the old file
/// stays as it was then.
BuildReport BuildMap(const BuildOptions& requested);

}  // namespace floorloc
