// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mapbuilder/report/floor_grid.h"
#include "mapbuilder/report/map_evidence.h"

namespace floorloc {

/// Weakness of a part of the floor.
enum class Weakness : std::uint8_t {
  kNone,
  kNotSurveyed,   ///< a hole or gap in the surveyed floor
  kFewKeypoints,  ///< too little texture: plain, blurred or dark
  kObservedOnce,  ///< keypoints not confirmed by a second frame
  kSelfSimilar,   ///< keypoints with duplicates at other places
  kStrained,      ///< links inconsistent with the frames' poses
  kNotFound,      ///< held-out frame not localized, or wrongly
};

struct QualityOptions {
  double cells_per_view = 8.0;        ///< along a side of the view
  double max_cells = 60'000.0;        ///< over the surveyed floor; larger floors get larger cells
  double max_side_cells = 20'000.0;   ///< a side; OpenCV warps images of up to 32766 pixels a side
  double needed_keypoints = 100.0;    ///< usable ones in view; with fewer, badly lit frames are not localized
  std::uint8_t duplicate_below = 26;  ///< keypoints of lower distinctiveness count as duplicates
  double weight_observed_once = 0.5;  ///< of a keypoint that only one frame observed
  double weight_duplicate = 0.2;      ///< of a keypoint with a duplicate
  double strained_sigma = 4.0;        ///< RMS over a frame's links from which on it counts as strained,
  double strained_px = 1.0;           ///< if it is also off by this, pixels of the rectified image: less harms nobody
  double min_share_in_view = 0.4;     ///< share of the view that must be surveyed for a place to be assessed
  double min_zone_views = 0.2;        ///< area of the smallest reported zone, in views
  double max_hole_views = 25.0;       ///< area in views; larger holes are taken for furniture

  void Check() const;
};

/// A connected area with one weakness.
struct Zone {
  Weakness weakness = Weakness::kNone;
  std::vector<std::size_t> cells;
  double area_m2 = 0.0;
  RectM box;
  Eigen::Vector2d mark = Eigen::Vector2d::Zero();  ///< a point in the zone, near its centre
  double usable_in_view = 0.0;                     ///< minimum over the zone
  int lost_frames = 0;                             ///< dropped frames in the zone
  int held_out_failures = 0;                       ///< held-out frames in the zone that were not localized, or wrongly
  double importance = 0.0;
};

/// Disagreement of a link with the poses of its frames.
struct LinkStrain {
  double error_m = 0.0;  ///< at the centre of the second frame's view
  double sigma = 0.0;
};

struct MapQuality {
  FloorGrid grid;
  Eigen::Vector2d drawing_origin_m = Eigen::Vector2d::Zero();  ///< DrawingOrigin of the map
  double view_m2 = 0.0;                                        ///< floor in a frame's view

  // Per cell.
  std::vector<int> coverage;           ///< number of frames that cover it
  std::vector<float> keypoints_m2;     ///< smoothed over a quarter of a view; negative: not covered
  std::vector<float> usable_m2;        ///< the same for weighted keypoints
  std::vector<float> usable_in_view;   ///< weighted keypoints in a view around the cell; negative: not assessed
  std::vector<float> distinctiveness;  ///< mean over the keypoints in view, 0..1; negative: none
  std::vector<Weakness> weakness;

  std::vector<Zone> zones;  ///< most important first
  double surveyed_m2 = 0.0;
  double judged_m2 = 0.0;
  double weak_m2 = 0.0;       ///< surveyed floor in zones
  double furniture_m2 = 0.0;  ///< holes too large to be omissions

  std::vector<LinkStrain> link_strain;  ///< per link
  std::vector<double> frame_error_m;    ///< per frame, RMS over its links
  std::vector<double> frame_sigma;      ///< per frame, RMS over its links
  std::vector<int> frame_links;         ///< per frame
};

/// Linear in frames, links, keypoints and cells.
MapQuality MeasureQuality(const MapEvidence& evidence, const QualityOptions& options);

}  // namespace floorloc
