// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace floorloc {

/// How often a map point was observed and covered, and its appearance.
struct PointHistory {
  int found = 0;    ///< frames that observed it, at least one
  int visible = 0;  ///< frames that covered it; values below `found` count as `found`
  float response = 0.0F;
  std::uint8_t distinctiveness = 255;  ///< as in MapKeypoints
};

/// Expected probability that a further frame that covers a point observes it: the share of the frames other than its
/// first that did, shrunk towards the share among points of similar response (empirical Bayes, since a single point has
/// few frames but a response bin has many points).
class RepeatRates {
 public:
  /// Estimates the shares from these points.
  explicit RepeatRates(const std::vector<PointHistory>& points);

  /// Rate of existing points of this response.
  double OfResponse(float response) const;
  double Of(const PointHistory& point) const;

 private:
  std::vector<float> upper_responses_;  // upper limits of all bins but the last
  std::vector<double> rates_;           // per bin
};

/// Value of a point for localization: repeat rate times distinctiveness, 0 ... 1.
std::vector<double> Usefulness(const std::vector<PointHistory>& points, const RepeatRates& rates);

/// Treats all points as distinctive in cells where many have a nearly equal duplicate at another place. Otherwise a map
/// of nearly identical tiles would keep what distinguishes them and lose the duplicates by which the localizer detects
/// ambiguity; measured without this, a tenth of its fixes there were wrong.
void IgnoreDuplicatesWhereCommon(const std::vector<Eigen::Vector2d>& positions, double cell_m,
                                 std::vector<PointHistory>* points);

}  // namespace floorloc
