// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/aruco.hpp>
#include <string>
#include <vector>

namespace floorloc {

/// The predefined marker dictionaries, by OpenCV's names: "DICT_4X4_50" ... "DICT_APRILTAG_36h11".
std::vector<std::string> ArucoDictionaryNames();

/// Throws std::invalid_argument for a name that is none of ArucoDictionaryNames().
cv::Ptr<cv::aruco::Dictionary> FindArucoDictionary(const std::string& name);

}  // namespace floorloc
