// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/merge/join_keypoints.h"

#include <algorithm>

#include "mapbuilder/finished_map/same_points.h"

namespace floorloc {
namespace {

void Append(const MapKeypoints& from, std::size_t i, int survey_shift, MapKeypoints* to) {
  to->keypoints.push_back(from.keypoints[i]);
  to->descriptors.push_back(from.descriptors.row(static_cast<int>(i)));
  to->observations.push_back(from.observations[i]);
  to->distinctiveness.push_back(from.distinctiveness[i]);
  to->last_survey.push_back(static_cast<std::uint16_t>(from.last_survey[i] + survey_shift));
}

// Moves a keypoint towards another observation of its floor point by a share of the difference.
void MoveTowards(const Keypoint& other, double share, Keypoint* k) {
  k->x_m = static_cast<float>(k->x_m + share * (other.x_m - k->x_m));
  k->y_m = static_cast<float>(k->y_m + share * (other.y_m - k->y_m));
  k->angle_rad = static_cast<float>(WrapAngle(k->angle_rad + share * WrapAngle(other.angle_rad - k->angle_rad)));
}

}  // namespace

MapKeypoints JoinKeypoints(const MapKeypoints& first, const MapKeypoints& second, double resolution_m,
                           int first_count) {
  MapKeypoints joined = first;
  joined.descriptors = first.descriptors.clone();
  std::vector<bool> known(second.size(), false);
  for (const Match& match : FindSamePoints(first, second, resolution_m)) {
    const auto i = static_cast<std::size_t>(match.query);
    const auto j = static_cast<std::size_t>(match.train);
    known[j] = true;
    const double all = joined.observations[i] + second.observations[j];
    MoveTowards(second.keypoints[j], second.observations[j] / std::max(1.0, all), &joined.keypoints[i]);
    if (second.observations[j] > first.observations[i]) {
      second.descriptors.row(match.train).copyTo(joined.descriptors.row(match.query));
    }
    joined.observations[i] = static_cast<std::uint16_t>(std::min(65535.0, all));
    joined.distinctiveness[i] = std::min(first.distinctiveness[i], second.distinctiveness[j]);
    joined.last_survey[i] = static_cast<std::uint16_t>(second.last_survey[j] + first_count);
  }
  for (std::size_t j = 0; j < second.size(); ++j) {
    if (!known[j]) {
      Append(second, j, first_count, &joined);
    }
  }
  return joined;
}

}  // namespace floorloc
