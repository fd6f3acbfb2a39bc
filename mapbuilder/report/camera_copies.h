// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/map/floor_map.h"
#include "core/map/mosaic_raster.h"

namespace floorloc {

/// Deciding numbers: tests/mapbuilder/report/camera_copies_test.cpp and docs/survey.md have the measurements.
struct CameraCopyOptions {
  int max_frames = 400;    ///< spread over each survey
  int min_frames = 24;     ///< of a survey; fewer prove nothing
  int blocks = 16;         ///< along the longer side of the view
  int controls = 3;        ///< how often the same views are cut beside their places, for what the floor repeats itself
  double min_shift = 0.3;  ///< how far beside, as a share of the view's longer side; at least and at most
  double max_shift = 0.9;
  double min_floor = 0.8;  ///< share of a block that must be surveyed
  /// Mean correlation of a block over pairs of frames, beyond that of the controls: in units of its standard deviation
  /// by chance, and at least. A part that is in a tenth of the frames' views has the square of that, 0.01.
  double min_sigmas = 8.0;
  double min_correlation = 0.004;
  /// Side of the smallest square of blocks that is believed, and least share of the view of a connected region: joints
  /// between tiles that keep step with the frames are lines.
  int min_side_blocks = 2;
  double min_share = 0.03;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// What of a camera's view is in the mosaic again and again, at the same place relative to the frames: no floor, but
/// something that moved with the camera.
struct CameraCopies {
  int survey = 0;      ///< index into MapInfo::cameras
  int frames = 0;      ///< looked at
  double share = 0.0;  ///< of the view, 0..1
  cv::Mat blocks;      ///< CV_8UC1 over the region of interest as seen from above, forward up; 255 where it repeats
};

/// Looks for it in every survey with enough frames; those with copies. Some milliseconds a frame.
std::vector<CameraCopies> FindCameraCopies(const FloorMap& map, const std::vector<MapFrame>& frames,
                                           const MosaicTileSource& tiles, const CameraCopyOptions& options = {});

}  // namespace floorloc
