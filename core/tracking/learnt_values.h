// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/fusion/learnt_odometry.h"
#include "core/odometry/learned_mask.h"
#include "core/tracking/camera_estimator.h"
#include "core/tracking/readout_estimator.h"

namespace floorloc {

/// What a vehicle's messages taught about it beside its pose. Holds for one vehicle with one camera.
struct LearntValues {
  std::optional<LearntOdometry> odometry;
  LearntCamera camera;
  std::vector<ReadoutMeasurement> readout;
  MaskEvidence mask;
};

/// CameraKeys that values were learnt with.
struct LearntWith {
  std::size_t given = 0;   ///< the camera as it is registered
  std::size_t in_map = 0;  ///< as its map corrects it

  bool operator==(const LearntWith&) const = default;
};

/// What of them holds with another camera: the mask needs the same images; the others, which fixes taught, the same
/// calibration too.
LearntValues HeldWith(const LearntWith& now, LearntValues learnt, const LearntWith& before);

/// As numbers that outlive the process, and back. Empty for numbers that ToNumbers of this version does not write:
/// another format, another count, values that nothing teaches.
std::vector<double> ToNumbers(const LearntValues& learnt);
std::optional<LearntValues> FromNumbers(const std::vector<double>& numbers);

}  // namespace floorloc
