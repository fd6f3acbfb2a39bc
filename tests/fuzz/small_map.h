// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

#include "core/geometry/floor_plane.h"
#include "core/geometry/pose2.h"

namespace floorloc {

/// A camera of 96 x 72 pixels that looks straight down on 0.32 x 0.24 m, whatever it sees at the size of a stamp: maps
/// of its images are small and quickly made.
FloorCamera SmallCamera();

/// What it sees of a random floor of 2 x 2 m at a place of the robot, from 0.2 to 1.6 m in x and y: CV_8UC1.
cv::Mat SmallImage(double x_m, double y_m);

/// A survey of `count` frames with odometry, 6 cm apart in x, from a place on.
void WriteSmallSurvey(const std::filesystem::path& folder, double x_m, int count);

/// Builds a map of such a survey, its journal and reports as any map's.
void WriteSmallMap(const std::filesystem::path& survey, const std::filesystem::path& map);

}  // namespace floorloc
