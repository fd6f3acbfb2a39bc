// SPDX-License-Identifier: Apache-2.0
#include "core/map/floor_map.h"

namespace floorloc {

Eigen::Vector2d KeypointOrigin(const RectM& extent) {
  constexpr double kStepM = 1000.0;
  return kStepM * (extent.Center() / kStepM).array().round().matrix();
}

}  // namespace floorloc
