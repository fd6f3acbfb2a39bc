// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/geometry/pose2.h"

namespace floorloc {

/// Deciding numbers: tests/mapbuilder/screening/fixed_structure_test.cpp and docs/survey.md have the measurements.
struct FixedStructureOptions {
  int width_px = 320;   ///< images are shrunk by an integer to at least this width: contrast, noise and time
  int min_pairs = 6;    ///< fewer pairs of images prove nothing
  int window_px = 5;    ///< side of the window in which two images are compared, at half of that resolution
  int light_px = 11;    ///< side of the window whose median is light, likewise: what is smoother is not structure
  double noise = 0.01;  ///< contrast below this is noise, as a share of the brightness
  /// A pair counts when the floor's motion explains this share of what one of the hypotheses explains.
  double min_moving_share = 0.2;
  double min_decided_share = 0.1;        ///< of the view in which the floor is seen moving in such a pair
  double min_standing = 0.5;             ///< correlation of structure that stands still
  double min_lead = 0.25;                ///< by which standing still must explain it better than the floor's motion
  double min_vote_share = 0.7;           ///< of the pairs that must show it
  double max_floor_share = 0.3;          ///< of the pairs in which the floor shows through, in what is masked
  double max_variation = 0.3;            ///< variance over time in what is masked, as a share of the floor's
  double max_relative_variation = 0.08;  ///< or as a share of its own structure's energy, which exposure scales
  double min_seed_share = 0.02;          ///< of a masked region's pixels that have proven structure
  int margin_px = 1;                     ///< around what is masked, pixels of the camera
  int min_region_px = 6;                 ///< smaller regions are left, pixels of the shrunk image

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Two grey images of a camera (CV_8UC1 of its size) and the motion of the base frame between them.
struct MovedImages {
  cv::Mat first;
  cv::Mat second;
  Pose2 first_from_second;
};

/// What stands still in the images of a camera while the floor moves.
struct FixedStructure {
  int pairs = 0;         ///< that showed the floor moving
  bool decided = false;  ///< false: too few of them, the mask is empty
  cv::Mat mask;          ///< CV_8UC1 of the camera's size, 0 where it is not floor; empty: nothing was found
};

/// For every pixel, compares how well two hypotheses explain the pairs: it stands still in the image, or it moves as
/// the floor does. Structure that both explain (lines along the motion, tiles moved by a period, a camera at rest) or
/// none proves nothing. What stands still and hides the floor is masked, together with the parts of it that have no
/// structure; shadows and light, through which the floor is seen moving, are not.
FixedStructure FindFixedStructure(const FloorCamera& camera, const std::vector<MovedImages>& pairs,
                                  const FixedStructureOptions& options, int threads = 1);

}  // namespace floorloc
