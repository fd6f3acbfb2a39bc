// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/calibration/calibration_case.h"

#include <numbers>

namespace floorloc {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

CalibrationCase OneCamera(const std::string& name, const CalibrationError& error) { return {name, error, error}; }

}  // namespace

std::vector<CalibrationCase> CalibrationCases() {
  const CalibrationError usual = CalibrationError::Typical(0.3, 0.1 * kDegree);
  return {OneCamera("exact", {}),
          OneCamera("0.25 px", CalibrationError::Typical(0.25, 0.0)),
          OneCamera("0.5 px", CalibrationError::Typical(0.5, 0.0)),
          OneCamera("1 px", CalibrationError::Typical(1.0, 0.0)),
          OneCamera("2 px", CalibrationError::Typical(2.0, 0.0)),
          OneCamera("radial 1 px", {.radial_px = 1.0}),
          OneCamera("tangential 1 px", {.tangential_px = 1.0}),
          OneCamera("principal point 3 px", {.principal_point_px = 3.0}),
          OneCamera("focal length 0.5 %", {.focal_share = 0.005}),
          OneCamera("floor 0.3 deg, 2 mm", {.roll_rad = 0.3 * kDegree, .pitch_rad = -0.2 * kDegree, .height_m = 0.002}),
          OneCamera("0.3 px, 0.1 deg", usual),
          {"other camera, 0.5 px", {}, CalibrationError::Typical(0.5, 0.0)},
          {"other camera, 1 px", {}, CalibrationError::Typical(1.0, 0.0)},
          {"bumped camera, 1 deg", usual, {.roll_rad = kDegree, .pitch_rad = -0.7 * kDegree, .height_m = 0.002}},
          {"other camera, 0.5 px, 0.2 deg", usual, CalibrationError::Typical(-0.5, -0.2 * kDegree)}};
}

}  // namespace floorloc
