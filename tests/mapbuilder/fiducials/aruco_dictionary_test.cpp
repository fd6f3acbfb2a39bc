// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/fiducials/aruco_dictionary.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <string>

namespace floorloc {
namespace {

// The inner modules of a drawn marker, row by row from the top: 1 is white.
std::string Modules(const cv::Ptr<cv::aruco::Dictionary>& dictionary, int id) {
  cv::Mat image;
  cv::aruco::drawMarker(dictionary, id, dictionary->markerSize + 2, image);
  std::string text;
  for (int row = 1; row <= dictionary->markerSize; ++row) {
    for (int column = 1; column <= dictionary->markerSize; ++column) {
      text += image.at<std::uint8_t>(row, column) != 0 ? '1' : '0';
    }
    text += row < dictionary->markerSize ? " " : "";
  }
  return text;
}

TEST(PublishedDictionary, HoldsAprilTagsAsAprilRoboticsPublishesThem) {
  // From TAG/alltags.ps of github.com/AprilRobotics/apriltag-imgs, without the border; 36h10: tag36h10.c of apriltag.
  EXPECT_EQ(Modules(FindPublishedDictionary("DICT_APRILTAG_16h5"), 0), "0010 0011 0001 1011");
  EXPECT_EQ(Modules(FindPublishedDictionary("DICT_APRILTAG_16h5"), 29), "1010 1111 0010 1110");
  EXPECT_EQ(Modules(FindPublishedDictionary("DICT_APRILTAG_25h9"), 0), "10101 01011 10010 11111 10001");
  EXPECT_EQ(Modules(FindPublishedDictionary("DICT_APRILTAG_36h11"), 0), "110101 011101 011000 101000 010110 000100");
  EXPECT_EQ(Modules(FindPublishedDictionary("DICT_APRILTAG_36h11"), 1), "110110 010111 111100 011000 101101 001001");
  EXPECT_EQ(Modules(FindPublishedDictionary("DICT_APRILTAG_36h10"), 0), "000111 001010 100100 101010 011010 000111");
}

TEST(PublishedDictionary, LeavesArucoMarkersAndOpenCvsDictionaryAlone) {
  for (const char* name : {"DICT_4X4_50", "DICT_6X6_250", "DICT_ARUCO_ORIGINAL"}) {
    EXPECT_EQ(Modules(FindPublishedDictionary(name), 7), Modules(FindArucoDictionary(name), 7));
  }
  FindPublishedDictionary("DICT_APRILTAG_16h5");
  EXPECT_EQ(Modules(FindArucoDictionary("DICT_APRILTAG_16h5"), 0), "1101 1000 1100 0100");
}

TEST(PublishedDictionary, HoldsEveryTag) {
  const auto opencv = FindArucoDictionary("DICT_APRILTAG_36h11");
  const auto published = FindPublishedDictionary("DICT_APRILTAG_36h11");
  ASSERT_EQ(published->bytesList.rows, opencv->bytesList.rows);
  for (int id = 0; id < opencv->bytesList.rows; ++id) {
    const std::string upright = Modules(published, id);
    EXPECT_EQ(std::string(upright.rbegin(), upright.rend()), Modules(opencv, id));
  }
}

}  // namespace
}  // namespace floorloc
