// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "tests/bench/calibration/calibration_trial.h"

namespace floorloc {

/// A drive at 1 m/s, its camera read out row by row, tracked as a vehicle's.
struct ReadoutRow {
  double readout_s = 0.0;
  CalibrationScore given;    ///< camera.yaml tells the read-out
  CalibrationScore unknown;  ///< it does not
  CalibrationScore ignored;  ///< it claims a global shutter
  double learnt_s = 0.0;     ///< by the unknown camera's images; NaN: not learnt
  double learnt_sigma_s = 0.0;
};

struct ReadoutTrialOptions {
  std::filesystem::path folder;  ///< of recordings and the map, made once
  std::string photograph;        ///< image of a floor
  int frames = 60;
  double speed_m_per_s = 1.0;
};

/// Builds a map and tracks drives with read-outs of 0, 5, 10, 20 and 33 ms in it, reporting each. Errors are those of
/// the fixes, in the frame of the map, after its similarity to the truth.
void RunReadouts(const ReadoutTrialOptions& options, const std::function<void(const ReadoutRow&)>& report);

}  // namespace floorloc
