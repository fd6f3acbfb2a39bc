// SPDX-License-Identifier: Apache-2.0
#include "core/diagnosis/diagnosis.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/diagnosis/part_findings.h"
#include "core/diagnosis/readout_finding.h"
#include "core/geometry/option_check.h"

namespace floorloc {

void DiagnosisOptions::Check() const {
  RequireOption(min_images >= 1, "min_images must be at least 1");
  RequireOption(min_localized_share > 0.0 && min_localized_share <= 1.0, "min_localized_share must be 0 to 1");
  RequireOption(lost_localized_share >= 0.0 && lost_localized_share <= min_localized_share,
                "lost_localized_share must be at most min_localized_share");
  RequireOption(blur_speed_ratio > 1.0, "blur_speed_ratio must be above 1");
  RequireOption(max_step_share > 0.0, "max_step_share must be positive");
  RequireOption(max_gap_s > 0.0, "max_gap_s must be positive");
  RequireOption(max_offset_s >= 0.0, "max_offset_s must not be negative");
  RequireOption(max_faulty_share >= 0.0, "max_faulty_share must not be negative");
  RequireOption(max_scale_error >= 0.0, "max_scale_error must not be negative");
  RequireOption(max_stamp_lag_s >= 0.0, "max_stamp_lag_s must not be negative");
  RequireOption(max_interval_s > 0.0, "max_interval_s must be positive");
  RequireOption(max_backward_share >= 0.0, "max_backward_share must not be negative");
  RequireOption(max_gyro_scale_error >= 0.0, "max_gyro_scale_error must not be negative");
  RequireOption(max_gyro_bias_rad_s >= 0.0, "max_gyro_bias_rad_s must not be negative");
  RequireOption(min_turn_rad > 0.0, "min_turn_rad must be positive");
  RequireOption(max_pair_s > 0.0, "max_pair_s must be positive");
}

ObservedCamera ObservedCamera::Of(const CameraEstimate& estimate, double off_px, const FloorCamera& camera) {
  const RectM& roi = camera.floor.roi;
  return {estimate, off_px, std::min(roi.width_m(), roi.height_m()), camera.camera.readout};
}

Finding FindingOfGyro(const GyroFit& fit, const DiagnosisOptions& options) {
  if (fit.turned_rad < options.min_turn_rad) {
    return {"gyro", FindingStatus::kUnknown, "the drive has too few turns to judge the gyro", "drive a circle"};
  }
  constexpr double kDegreeScale = std::numbers::pi / 180.0;
  if (fit.scale > 0.5 * kDegreeScale && fit.scale < 2.0 * kDegreeScale) {
    return {"gyro", FindingStatus::kWrong, "the gyro is in degrees per second", "give its turns in radians per second"};
  }
  if (fit.scale < 0.0) {
    return {"gyro", FindingStatus::kWrong, "the gyro turns right while the images turn left",
            "turn its axes to those of the base (z up), or change its sign"};
  }
  const std::string numbers = FormatSentence("scale %.3f, bias %+.4f rad/s", fit.scale, fit.bias_rad_s);
  if (std::abs(fit.scale - 1.0) > options.max_gyro_scale_error) {
    return {"gyro", FindingStatus::kWrong, "the gyro's turns are not those of the images: " + numbers,
            "check its range and unit"};
  }
  if (std::abs(fit.bias_rad_s) > options.max_gyro_bias_rad_s) {
    return {"gyro", FindingStatus::kNote, "the gyro has a large bias, which is estimated along the way: " + numbers,
            "calibrate it at standstill"};
  }
  return {"gyro", FindingStatus::kOk, "the gyro agrees with the images: " + numbers, ""};
}

std::vector<Finding> Diagnose(const DriveRecord& record, const ObservedCamera& camera,
                              const std::optional<GyroFit>& gyro, const DiagnosisOptions& options) {
  options.Check();
  std::vector<Finding> findings{FindingOfFloor(record, options), FindingOfImages(record, camera.view_m, options),
                                FindingOfCamera(camera)};
  const std::vector<Finding> readout = FindingsOfReadout(camera.readout, camera.estimate.readout);
  findings.insert(findings.end(), readout.begin(), readout.end());
  const std::vector<Finding> odometry = FindingsOfOdometry(record, options);
  findings.insert(findings.end(), odometry.begin(), odometry.end());
  if (gyro) {
    findings.push_back(FindingOfGyro(*gyro, options));
  }
  return findings;
}

}  // namespace floorloc
