// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace floorloc {

/// Images that do not show a map's floor.
struct StrangeViews {
  std::string name;
  std::vector<cv::Mat> images;  ///< CV_8UC1
};

/// What stops a camera from seeing the floor: a lens cap, darkness, glare, a wall close by, a foot and a pallet.
/// raw_px: size of the images.
std::vector<StrangeViews> SimulatedStrangeViews(cv::Size raw_px);

/// At most `count` images of a folder or of all its subfolders, at the camera's size.
StrangeViews ReadStrangeViews(const std::string& name, const std::filesystem::path& folder, cv::Size raw_px, int count);

}  // namespace floorloc
