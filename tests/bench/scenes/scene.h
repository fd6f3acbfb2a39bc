// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/localization/localizer.h"
#include "tests/bench/scenes/cases.h"

namespace floorloc {

/// An image to localize.
struct SceneFrame {
  cv::Mat raw;  ///< CV_8UC1
  Pose2 truth_from_base;
  PosePrior prior;  ///< its pose is truth_from_base, with an error within its bounds
};

/// Frames taken under the same conditions.
struct FrameGroup {
  std::string name;
  FloorCamera camera;
  std::vector<SceneFrame> frames;
};

/// A surveyed floor and frames on it; the survey has ground truth.
struct Scene {
  std::filesystem::path survey;
  std::vector<FrameGroup> groups;
};

/// Five small floors of different kinds. photograph: image of a floor from which one texture is quilted.
std::vector<FloorCase> SceneFloors(const std::string& photograph);

/// Makes the floor and its survey in the folder, and `frames` mild and `frames` hard frames of it. Throws InputError
/// when the folder cannot be written.
Scene SimulateScene(const std::filesystem::path& folder, const FloorCase& floor, int frames);

/// Reads recorded folders in the survey format with ground truth. Throws InputError.
Scene ReadScene(const std::filesystem::path& survey, const std::vector<std::filesystem::path>& frames);

}  // namespace floorloc
