// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/registration/registration.h"

namespace floorloc {

/// A camera's read-out by one image of a moving robot.
struct ReadoutMeasurement {
  double seconds = 0.0;  ///< from the first to the last row in the camera's direction; negative: in the opposite one
  double sigma_s = 0.0;
};

/// How a read-out is measured: the matches of a sheared image agree with one pose only when each is moved back by the
/// time of its row. `./run bench calibration --case readout` measures it.
struct ReadoutFitOptions {
  double max_s = 0.045;  ///< longest read-out that is tried, in both directions
  /// A robot whose motion during max_s is smaller, at the fastest point of the view, does not show the read-out,
  /// metres.
  double min_motion_m = 0.002;
  int min_inliers = 30;
  /// Where such a share of the matches agrees as the image was rectified, the read-out is near: their number falls to
  /// both sides of it, and farther ones are not tried. A row is an inlier within a tenth of the longest read-out or so,
  /// which leaves a fifth of the matches of an image that is far off.
  double near_share = 0.4;
  /// What the calibration may shear the view by in all images alike, pixels between the first and the last row
  /// (PhotometricOptions::calibration_sigma_px, to both sides).
  double shear_px = 0.6;
  /// What a read-out that is as good as known may move a pose by, metres. Beyond it, an image is localized again with
  /// what it shows of its read-out, one that was learnt at a lower speed is measured again, and nothing is learnt of
  /// the camera's other errors, which look alike.
  double max_error_m = 3e-4;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Matches of an image that was rectified with another read-out, of zero or as assumed.
struct ReadoutProblem {
  std::vector<OrientedMatch> matches;
  std::vector<double> share;                        ///< ReadoutShare of each
  Eigen::Vector3d twist = Eigen::Vector3d::Zero();  ///< of the base, m/s and rad/s
  double resolution_m = 0.0;                        ///< of the rectified image
};

/// Speed of the fastest matched point, m/s.
double FastestPoint(const ReadoutProblem& problem);

/// False for a robot that is too slow everywhere in its view (roi, base frame). twist: (vx, vy, omega), m/s and rad/s.
bool ShowsReadout(const RectM& roi, const Eigen::Vector3d& twist, const ReadoutFitOptions& options);

/// Tries read-outs, keeps the one under which most matches agree, and refines it by least squares together with the
/// pose and the camera's height. Relative to the read-out that the image was rectified with. Empty: the robot is too
/// slow, or too few matches agree.
std::optional<ReadoutMeasurement> FitReadout(const ReadoutProblem& problem, const RegistrationOptions& registration,
                                             const ReadoutFitOptions& options = {});

}  // namespace floorloc
