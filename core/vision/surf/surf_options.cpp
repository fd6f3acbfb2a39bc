// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>

#include "core/vision/surf/surf.h"

namespace floorloc {
namespace {

void Require(bool ok, const char* message) {
  if (!ok) {
    throw std::invalid_argument(message);
  }
}

}  // namespace

void SurfOptions::Check() const {
  Require(threshold >= 0.0 && threshold <= 1e6, "threshold must be 0 to 1000000");
  Require(octaves >= 1 && octaves <= 8, "octaves must be 1 to 8");
  Require(layers >= 1 && layers <= 8, "layers must be 1 to 8");
  Require(first_step_px == 1 || first_step_px == 2, "first_step_px must be 1 or 2");
  Require(max_keypoints >= 0, "max_keypoints must be 0 (all) or more");
}

}  // namespace floorloc
