// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/placement/pair_registration.h"
#include "mapbuilder/self_calibration/camera_adjustment.h"
#include "mapbuilder/self_calibration/link_sigmas.h"

namespace floorloc {

struct SelfCalibrationOptions {
  /// Estimates all unknowns that the survey makes observable; `unknowns` is not used.
  bool automatic = true;
  std::vector<CameraUnknown> unknowns;  ///< of every survey's camera; empty: no self-calibration
  int observations_per_frame = 80;      ///< keypoints of a frame that take part
  double observation_sigma_px = 0.36;   ///< of a keypoint's coordinates, pixels of the rectified image
  /// The calibration is done when a round moves the floor in the image by less than this, pixels: a tenth of a
  /// keypoint's error.
  double settled_px = 0.05;
  /// An automatic calibration is given up when floor points scatter more than this in the frames, pixels, once the
  /// camera is calibrated: the frames are not those of one rigid camera over a plane.
  double max_scatter_px = 1.5;
  /// Errors of neighbouring keypoints are alike (wood grain, blur), so the images tell less than as many independent
  /// observations of the same scatter: standard deviations grow by this. Chosen on simulated wood, whose grain pulls p1
  /// off by six standard deviations without it (2026-11).
  double error_correlation = 4.0;
  /// An automatic calibration estimates an unknown when its standard deviation is below this share of what a usual
  /// calibration leaves, or when the images contradict the calibration by `contradiction_sigmas`.
  double observable_share = 0.5;
  double contradiction_sigmas = 4.0;
  double distance_sigma_m = 1e-3;  ///< of known distances
  double unmodelled_px = 0.1;      ///< what no unknown of the calibration describes, at the corners
  double tilt_rad = 5e-4;          ///< vibration of a frame's roll and pitch, standard deviation
  double tilt_height = 5e-4;       ///< and of its height, as a share
  /// The same where each frame has a height of its own: what the links' scale leaves of it.
  double own_height = 5e-3;
  LinkSigmaOptions link_sigmas;
  PairRegistrationOptions registration;  ///< for the links, which are measured again

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Parses names from the command line: "auto", "none", or a list of "mounting" (roll and pitch), "height", "focal",
/// "distortion" (k1, k2, p1, p2). Throws std::invalid_argument.
void ParseCameraUnknowns(const std::vector<std::string>& names, SelfCalibrationOptions* options);

}  // namespace floorloc
