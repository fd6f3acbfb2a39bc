// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace floorloc {

/// How often a map point was observed, and its appearance.
struct PointHistory {
  int found = 0;    ///< frames that saw it, at least one
  int visible = 0;  ///< frames in whose view it was; taken to be at least `found`
  float response = 0.0F;
  std::uint8_t distinctiveness = 255;  ///< as in MapKeypoints
};

/// Expected probability that a further frame that covers a point observes it: the share of the frames other than its
/// first that did, drawn towards the share among points of like response (an empirical Bayes estimate: few frames say
/// little about one point, but much about all weak or all strong ones).
class RepeatRates {
 public:
  /// Learns the shares from these points.
  explicit RepeatRates(const std::vector<PointHistory>& points);

  /// Of points of this response that are known to exist.
  double OfResponse(float response) const;
  double Of(const PointHistory& point) const;

 private:
  std::vector<float> upper_responses_;  // of all bins but the last
  std::vector<double> rates_;           // of each bin
};

/// What a point is worth to a localizer: its repeat rate times its distinctiveness.
std::vector<double> Usefulness(const std::vector<PointHistory>& points, const RepeatRates& rates);

/// Marks all points of those cells as distinctive in which many have a nearly equal duplicate elsewhere. Otherwise a
/// map of nearly identical tiles would keep what makes them differ and lose the duplicates, by which the localizer
/// detects the ambiguity there: measured, a tenth of its fixes was wrong.
void IgnoreDuplicatesWhereCommon(const std::vector<Eigen::Vector2d>& positions, double cell_m,
                                 std::vector<PointHistory>* points);

}  // namespace floorloc
