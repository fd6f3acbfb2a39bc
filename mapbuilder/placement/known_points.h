// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

namespace floorloc {

/// A floor point of a frame.
struct KnownPoint {
  Eigen::Vector2d local_m = Eigen::Vector2d::Zero();  ///< by images and odometry alone, in any frame
  Eigen::Vector2d known_m = Eigen::Vector2d::Zero();  ///< as surveyed, map frame
};

struct KnownPointOptions {
  /// Points agree when they are at most this far apart. Exact ones read to 0.5 px miss a map of 2.6 x 1.8 m by up to
  /// 0.8 mm; tape measures and long ways add centimetres.
  double agree_m = 0.02;
  /// Long surveys bend: points also agree within this many times the median residual, but never beyond the share of
  /// their extent.
  double agree_medians = 4.0;
  double agree_share = 0.05;
  /// A scale that is off by a larger factor is another unit. Screening bounds floor.yaml by the same factor.
  double max_scale = 1.15;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// How well known points fit the images by a rigid motion.
struct KnownPointFit {
  enum class Status {
    kFits,           ///< as given, up to `disagreeing` and `scale`
    kFitsOtherwise,  ///< `when` says how the coordinates would have to be read
    kContradictory   ///< most points disagree, however they are read
  };
  Status status = Status::kFits;
  std::string when;                      ///< "x and y are swapped, ..."; only if kFitsOtherwise
  std::vector<std::size_t> disagreeing;  ///< points that the majority contradicts; only if kFits
  double scale = 1.0;                    ///< distances as given over those in the images, where it explains the misfit
  std::vector<double> misfit_m;          ///< of every point, as given
};

/// Least median of squares (Rousseeuw 1984) over pairs of points, scale fixed at 1, for every way in which coordinates
/// are commonly mistaken: swapped or mirrored axes, other units, degrees. The way that most points agree with wins, and
/// as given on a tie. Collinear points can't tell a mirrored frame from a turned one.
KnownPointFit FitKnownPoints(const std::vector<KnownPoint>& points, const KnownPointOptions& options);

}  // namespace floorloc
