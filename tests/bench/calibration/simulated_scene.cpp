// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/calibration/simulated_scene.h"

namespace floorloc {

SimulateOptions SceneOptions(const std::string& photograph, double width_m, double height_m) {
  SimulateOptions options;
  options.floor.source = photograph;
  options.floor.width_m = width_m;
  options.floor.height_m = height_m;
  options.conditions = ConditionLevels::FromName("mild");
  return options;
}

void SimulateOnce(SimulateOptions options, const std::filesystem::path& out) {
  if (!std::filesystem::exists(out)) {
    options.out = out;
    Simulate(options);
  }
}

}  // namespace floorloc
