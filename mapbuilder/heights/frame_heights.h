// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/io/trajectory.h"
#include "core/vision/extractors/feature_extractor.h"
#include "mapbuilder/heights/height_graph.h"
#include "mapbuilder/heights/scale_registration.h"
#include "mapbuilder/placement/pair_registration.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

enum class FreeHeight {
  kAuto,  ///< where images differ in height by more than FrameHeightOptions::max_spread
  kOn,
  kOff,  ///< only measured, and reported
};

/// "auto", "on" or "off"; throws std::invalid_argument for others.
FreeHeight ParseFreeHeight(const std::string& name);

struct FrameHeightOptions {
  FreeHeight mode = FreeHeight::kAuto;
  /// Views that differ by more than this share in height match at one scale in their middle only: at 3 % a keypoint
  /// 100 px from it is 3 px off, and the inlier radius of pair registration is 2.9 px.
  double max_spread = 0.03;
  /// Pairs of neighbours in time, and of neighbours by odometry, that are compared before the heights are set free.
  int sampled_pairs = 16;
  /// Without odometry, and where most neighbours in time show no common floor, at most this many frames are searched
  /// for others of the same floor.
  int searched_frames = 100;
  int min_uneven_pairs = 3;  ///< of those, with heights that differ by more than max_spread
  int keypoints = 500;       ///< SIFT keypoints per frame
  int pairs_per_frame = 4;   ///< with frames that are not next to it in time
  ScaleRegistrationOptions scale;
  HeightGraphOptions graph;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Heights of the camera over the frames, as far as the images tell them.
struct FrameHeights {
  bool free = false;     ///< each frame has its own
  bool asked = false;    ///< and was asked to, whatever the spread
  double spread = 0.0;   ///< by how much frames that show the same floor differ in height, share
  double lowest = 1.0;   ///< of the frames, over the calibrated height; only if free
  double highest = 1.0;  ///< likewise
  std::string scale_by;  ///< what the map's scale comes from; only if free
};

/// What the heights are found with, besides the images.
struct HeightSources {
  const ExtractorOptions& extractor;            ///< of the map
  const PairRegistrationOptions& registration;  ///< at one height
  const Trajectory& poses;                      ///< of another system; may be empty
};

/// Measures by how much the frames differ in height, on a sample of pairs. Where that is too much for one height, finds
/// each frame's own from similarities between SIFT features (their scale is free), and extracts its features again at
/// that height. Images tell ratios only: the scale comes from poses, else odometry, else it is the calibrated height on
/// average. Throws InputError when images can't be read.
FrameHeights FindHeights(const FrameHeightOptions& options, const HeightSources& sources, FrameSet* set);

/// One sentence on uneven heights that nobody asked to allow for; empty: they are even, or somebody did.
std::string HeightWarning(const FrameHeights& heights);

}  // namespace floorloc
