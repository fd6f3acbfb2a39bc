// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "core/diagnosis/diagnosis.h"

namespace floorloc {

/// Whether the images are found in the map, and why not.
Finding FindingOfFloor(const DriveRecord& record, const DiagnosisOptions& options);
/// How far apart images are, against the length of a view.
Finding FindingOfImages(const DriveRecord& record, double view_m, const DiagnosisOptions& options);
Finding FindingOfCamera(const ObservedCamera& camera);
/// Odometry's direction, scale, yaw, rate and gaps, and its clock.
std::vector<Finding> FindingsOfOdometry(const DriveRecord& record, const DiagnosisOptions& options);
Finding FindingOfGyro(const GyroFit& fit, const DiagnosisOptions& options);

/// printf into a string of at most 511 characters.
template <typename... Values>
std::string FormatSentence(const char* format, Values... values) {
  char text[512];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

}  // namespace floorloc
