// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <vector>

#include "core/registration/registration.h"
#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/placement/pair_selection.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

struct ScaleRegistrationOptions {
  double resolution_m = 7e-4;  ///< of the rectified images
  /// Residual of an inlier, pixels: a camera tilted by 1 degree moves the corners of a view of 50 degrees by 5 px.
  double inlier_radius_px = 6.0;
  float max_ratio = 0.8F;  ///< of the distances of the nearest two descriptors (Lowe 2004)
  /// Scales beyond this and its inverse are not looked for.
  double max_scale = 3.0;
  int iterations = 1000;  ///< two-point samples; a share of inliers of 8 % is found in 99.8 % of all cases
  int min_inliers = 12;
  double max_p_wrong = 1e-5;
  /// Errors of neighbouring keypoints are alike, and lenses leave some: least standard deviation of a scale's
  /// logarithm.
  double min_log_sigma = 5e-4;
  RunOptions run;
  std::uint32_t seed = 1;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// target = factor * source + shift, with points as complex numbers; metres.
struct Similarity {
  std::complex<double> factor = 1.0;
  std::complex<double> shift = 0.0;
  std::vector<int> inliers;  ///< indices into the matches
  double log_sigma = 0.0;    ///< standard deviation of the scale's logarithm

  double scale() const { return std::abs(factor); }
  Eigen::Vector2d operator*(const Eigen::Vector2d& p) const {
    const std::complex<double> q = factor * std::complex<double>(p.x(), p.y()) + shift;
    return {q.real(), q.imag()};
  }
};

/// Robust similarity between oriented points: two-point RANSAC, then least squares on the inliers. Empty when there is
/// none, or when it may have come about by chance. area_m2: of the target points. Deterministic for a seed.
std::optional<Similarity> FitSimilarity(const std::vector<OrientedMatch>& matches, double area_m2,
                                        const ScaleRegistrationOptions& options);

/// Two frames that show the same floor from heights that need not be equal.
struct ScaleLink {
  int first = 0;
  int second = 0;
  Similarity first_from_second;  ///< as the calibrated height has both; its scale: the second's height over the first's
};

/// Matches every pair of frames without knowing where they lie; pairs that do not match give no link. The features must
/// be invariant to scale (SIFT), base frame of the calibrated height. Deterministic for any number of threads.
std::vector<ScaleLink> MeasureScales(const std::vector<BuildFrame>& frames, const std::vector<RectM>& floor_in_base,
                                     const std::vector<FramePair>& pairs, const ScaleRegistrationOptions& options);

}  // namespace floorloc
