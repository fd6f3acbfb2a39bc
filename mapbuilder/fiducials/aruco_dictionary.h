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

/// The same markers, upright as people print them. OpenCV before version 5 holds AprilTags turned by 180 degrees
/// against the images that AprilRobotics publishes (github.com/AprilRobotics/apriltag-imgs, tag36h11/alltags.ps; OpenCV
/// pull request 28823), so its corners begin at the lower right there. ArUco markers are the same in both.
cv::Ptr<cv::aruco::Dictionary> FindPublishedDictionary(const std::string& name);

}  // namespace floorloc
