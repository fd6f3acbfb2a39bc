// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mapbuilder/report/floor_grid.h"
#include "mapbuilder/report/map_evidence.h"

namespace floorloc {

/// What can be wrong with a piece of floor.
enum class Weakness : std::uint8_t {
  kNone,
  kNotSurveyed,   ///< a hole or a slit between surveyed floor
  kFewKeypoints,  ///< too little texture: plain, blurred or dark
  kObservedOnce,  ///< keypoints that no second frame confirms
  kSelfSimilar,   ///< keypoints that have duplicates elsewhere
  kStrained,      ///< frames' images and poses disagree
  kNotFound,      ///< a held-out frame was not localized, or wrongly
};

struct QualityOptions {
  double cells_per_view = 8.0;        ///< along the side of a view
  double max_cells = 60'000.0;        ///< over the surveyed floor; larger floors get larger cells
  double needed_keypoints = 100.0;    ///< usable ones in view: with fewer, frames in bad light are not found
  std::uint8_t duplicate_below = 26;  ///< keypoints of less distinctiveness count as duplicates
  double weight_observed_once = 0.5;  ///< weight of a keypoint that only one frame observed
  double weight_duplicate = 0.2;      ///< weight of a keypoint with a duplicate
  double strained_sigma = 4.0;        ///< RMS over a frame's links
  double min_share_in_view = 0.4;     ///< of the view that must be surveyed for a place to be judged
  double min_zone_views = 0.2;        ///< area of the smallest zone that is reported, views
  double max_hole_views = 25.0;       ///< larger holes are taken for furniture

  void Check() const;
};

/// A connected piece of floor with one weakness.
struct Zone {
  Weakness weakness = Weakness::kNone;
  std::vector<std::size_t> cells;
  double area_m2 = 0.0;
  RectM box;
  Eigen::Vector2d mark = Eigen::Vector2d::Zero();  ///< a place in the zone, near its middle
  double usable_in_view = 0.0;                     ///< where it has the fewest
  int lost_frames = 0;                             ///< frames that were left out here
  int held_out_failures = 0;                       ///< held-out frames that were not localized here, or wrongly
  double importance = 0.0;
};

/// How one link and the poses of its frames disagree.
struct LinkStrain {
  double error_m = 0.0;  ///< at the middle of the second frame's view
  double sigma = 0.0;
};

struct MapQuality {
  FloorGrid grid;
  double view_m2 = 0.0;  ///< floor in a frame's view

  // Per cell.
  std::vector<int> coverage;           ///< frames that saw it
  std::vector<float> keypoints_m2;     ///< smoothed over a quarter of a view; negative: no frame covers it
  std::vector<float> usable_m2;        ///< the same of weighted keypoints
  std::vector<float> usable_in_view;   ///< weighted keypoints in a view around the cell; negative: not judged
  std::vector<float> distinctiveness;  ///< mean 0..1 of the keypoints in view; negative: none
  std::vector<Weakness> weakness;

  std::vector<Zone> zones;  ///< the most important first
  double surveyed_m2 = 0.0;
  double judged_m2 = 0.0;
  double weak_m2 = 0.0;       ///< surveyed floor in zones
  double furniture_m2 = 0.0;  ///< of holes too large to be slips

  std::vector<LinkStrain> link_strain;  ///< per link
  std::vector<double> frame_error_m;    ///< per frame, RMS over its links
  std::vector<double> frame_sigma;      ///< per frame, RMS over its links
  std::vector<int> frame_links;         ///< per frame
};

/// Linear in frames, links, keypoints and cells.
MapQuality MeasureQuality(const MapEvidence& evidence, const QualityOptions& options);

}  // namespace floorloc
