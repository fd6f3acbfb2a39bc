// SPDX-License-Identifier: Apache-2.0
#include "server/serving/map_quality.h"

#include <cmath>
#include <map>
#include <utility>

namespace floorloc {

std::vector<QualityCell> MeasureQuality(const MapKeypoints& keypoints, double cell_m) {
  std::map<std::pair<int, int>, QualityCell> cells;
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const Eigen::Vector2d place = keypoints.PositionInMap(i) / cell_m;
    const auto x = static_cast<int>(std::floor(place.x()));
    const auto y = static_cast<int>(std::floor(place.y()));
    QualityCell& cell = cells[{y, x}];
    cell.x = x;
    cell.y = y;
    ++cell.keypoints;
    cell.observations += keypoints.observations[i];
    cell.distinctiveness += keypoints.distinctiveness.empty() ? 0.0 : keypoints.distinctiveness[i] / 255.0;
  }
  std::vector<QualityCell> sorted;
  for (auto& [key, cell] : cells) {
    cell.observations /= cell.keypoints;
    cell.distinctiveness /= cell.keypoints;
    sorted.push_back(cell);
  }
  return sorted;
}

}  // namespace floorloc
