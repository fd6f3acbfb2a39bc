// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/trajectory_evaluation.h"
#include "mapbuilder/batch/progress.h"
#include "mapbuilder/laboratory/combination.h"
#include "mapbuilder/laboratory/result_table.h"

namespace floorloc {

/// Score of one odometry method on a drive.
struct DriveScore {
  std::string name;                                ///< feature type or sensors
  std::optional<TrajectoryEvaluation> evaluation;  ///< empty: see failure_reason
  std::string failure_reason;
  int lost_frames = 0;
};

/// Evaluates monocular visual odometry for those of the features that it supports (ORB, AKAZE, BRISK) and, if the
/// folder has the data, wheel odometry, and IMU and wheel odometry fused by the Kalman filter without fixes; each
/// against groundtruth.tum (within 0.02 s). Monocular paths are those of the camera and are aligned including scale,
/// the others without scale. Throws InputError.
std::vector<DriveScore> ScoreDrive(const std::filesystem::path& drive, const std::vector<DetectorKind>& features,
                                   const ProgressOutput& progress);

/// Table 6: absolute position errors.
ResultTable DriveTable(const std::vector<DriveScore>& scores);

/// Writes one image per score: the path coloured by error, and error over time. Throws InputError.
void DrawDrive(const std::vector<DriveScore>& scores, const std::filesystem::path& folder);

}  // namespace floorloc
