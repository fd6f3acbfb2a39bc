// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/self_calibration/self_calibration_options.h"

#include <map>
#include <stdexcept>

#include "core/geometry/option_check.h"

namespace floorloc {

void ParseCameraUnknowns(const std::vector<std::string>& names, SelfCalibrationOptions* options) {
  using enum CameraUnknown;
  options->automatic = names == std::vector<std::string>{"auto"};
  options->unknowns.clear();
  if (options->automatic || names == std::vector<std::string>{"none"}) {
    return;
  }
  static const std::map<std::string, std::vector<CameraUnknown>> kNames = {
      {"mounting", {kRoll, kPitch}}, {"height", {kHeight}}, {"focal", {kFocal}}, {"distortion", {kK1, kK2, kP1, kP2}}};
  for (const std::string& name : names) {
    const auto found = kNames.find(name);
    if (found == kNames.end()) {
      throw std::invalid_argument("--self-calibrate: '" + name +
                                  "' is not auto, none, or a list of mounting, height, focal, distortion");
    }
    options->unknowns.insert(options->unknowns.end(), found->second.begin(), found->second.end());
  }
}

void SelfCalibrationOptions::Check() const {
  RequireOption(observations_per_frame >= 1, "observations_per_frame must be at least 1");
  RequireOption(observation_sigma_px > 0.0, "observation_sigma_px must be positive");
  RequireOption(max_scatter_px > 0.0, "max_scatter_px must be positive");
  RequireOption(error_correlation > 0.0, "error_correlation must be positive");
  RequireOption(contradiction_sigmas > 0.0, "contradiction_sigmas must be positive");
  RequireOption(observable_share > 0.0, "observable_share must be positive");
  RequireOption(distance_sigma_m > 0.0, "distance_sigma_m must be positive");
  RequireOption(unmodelled_px >= 0.0, "unmodelled_px must not be negative");
  RequireOption(settled_px > 0.0, "settled_px must be positive");
  RequireOption(tilt_rad >= 0.0, "tilt_rad must not be negative");
  RequireOption(tilt_height >= 0.0, "tilt_height must not be negative");
  RequireOption(own_height >= 0.0, "own_height must not be negative");
  link_sigmas.Check();
  registration.Check();
}

}  // namespace floorloc
