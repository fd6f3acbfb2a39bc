// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/build/map_frames.h"

namespace floorloc {

MapFramesAndLinks CollectMapFrames(const std::vector<BuildFrame>& frames, const Placement& placement,
                                   const Exposure& exposure, const BaseMap* base_map) {
  MapFramesAndLinks placed;
  int first_survey = 0;
  if (base_map != nullptr) {
    placed = {base_map->frames, base_map->links};
    first_survey = base_map->survey_count();
  }
  std::vector<int> number(frames.size(), -1);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (placement.map_from_base[i]) {
      number[i] = static_cast<int>(placed.frames.size());
      placed.frames.push_back({frames[i].info.stamp_ns, frames[i].info.filename, *placement.map_from_base[i],
                               first_survey + frames[i].survey, exposure.frame_gain[i], frames[i].odom_from_base});
    }
  }
  for (const Link& link : placement.links) {
    const auto first = static_cast<std::size_t>(link.first);
    const auto second = static_cast<std::size_t>(link.second);
    if (number[first] >= 0 && number[second] >= 0) {
      placed.links.push_back({number[first], number[second], link.first_from_second, link.covariance, link.inliers,
                              link.rms_m,
                              LinkResidual(link, *placement.map_from_base[first], *placement.map_from_base[second])});
    }
  }
  return placed;
}

}  // namespace floorloc
