// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/aruco.hpp>
#include <string>
#include <vector>

namespace floorloc {

/// Names of OpenCV's predefined marker dictionaries: "DICT_4X4_50" ... "DICT_APRILTAG_36h11".
std::vector<std::string> ArucoDictionaryNames();

/// Throws std::invalid_argument for a name not in ArucoDictionaryNames().
cv::Ptr<cv::aruco::Dictionary> FindArucoDictionary(const std::string& name);

}  // namespace floorloc
