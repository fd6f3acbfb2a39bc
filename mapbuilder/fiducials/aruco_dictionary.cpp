// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/fiducials/aruco_dictionary.h"

#include <array>
#include <opencv2/core.hpp>
#include <stdexcept>

namespace floorloc {
namespace {

struct NamedDictionary {
  const char* name;
  cv::aruco::PREDEFINED_DICTIONARY_NAME value;
};

constexpr std::array kDictionaries{
    NamedDictionary{"DICT_4X4_50", cv::aruco::DICT_4X4_50},
    NamedDictionary{"DICT_4X4_100", cv::aruco::DICT_4X4_100},
    NamedDictionary{"DICT_4X4_250", cv::aruco::DICT_4X4_250},
    NamedDictionary{"DICT_4X4_1000", cv::aruco::DICT_4X4_1000},
    NamedDictionary{"DICT_5X5_50", cv::aruco::DICT_5X5_50},
    NamedDictionary{"DICT_5X5_100", cv::aruco::DICT_5X5_100},
    NamedDictionary{"DICT_5X5_250", cv::aruco::DICT_5X5_250},
    NamedDictionary{"DICT_5X5_1000", cv::aruco::DICT_5X5_1000},
    NamedDictionary{"DICT_6X6_50", cv::aruco::DICT_6X6_50},
    NamedDictionary{"DICT_6X6_100", cv::aruco::DICT_6X6_100},
    NamedDictionary{"DICT_6X6_250", cv::aruco::DICT_6X6_250},
    NamedDictionary{"DICT_6X6_1000", cv::aruco::DICT_6X6_1000},
    NamedDictionary{"DICT_7X7_50", cv::aruco::DICT_7X7_50},
    NamedDictionary{"DICT_7X7_100", cv::aruco::DICT_7X7_100},
    NamedDictionary{"DICT_7X7_250", cv::aruco::DICT_7X7_250},
    NamedDictionary{"DICT_7X7_1000", cv::aruco::DICT_7X7_1000},
    NamedDictionary{"DICT_ARUCO_ORIGINAL", cv::aruco::DICT_ARUCO_ORIGINAL},
    NamedDictionary{"DICT_APRILTAG_16h5", cv::aruco::DICT_APRILTAG_16h5},
    NamedDictionary{"DICT_APRILTAG_25h9", cv::aruco::DICT_APRILTAG_25h9},
    NamedDictionary{"DICT_APRILTAG_36h10", cv::aruco::DICT_APRILTAG_36h10},
    NamedDictionary{"DICT_APRILTAG_36h11", cv::aruco::DICT_APRILTAG_36h11},
};

}  // namespace

std::vector<std::string> ArucoDictionaryNames() {
  std::vector<std::string> names;
  for (const NamedDictionary& dictionary : kDictionaries) {
    names.emplace_back(dictionary.name);
  }
  return names;
}

cv::Ptr<cv::aruco::Dictionary> FindArucoDictionary(const std::string& name) {
  for (const NamedDictionary& dictionary : kDictionaries) {
    if (name == dictionary.name) {
      return cv::aruco::getPredefinedDictionary(dictionary.value);
    }
  }
  throw std::invalid_argument("the marker dictionary '" + name +
                              "' is unknown; use one of OpenCV's names, such as DICT_4X4_50 or DICT_APRILTAG_36h11");
}

cv::Ptr<cv::aruco::Dictionary> FindPublishedDictionary(const std::string& name) {
  const cv::Ptr<cv::aruco::Dictionary> opencv = FindArucoDictionary(name);
  if (!name.starts_with("DICT_APRILTAG_")) {
    return opencv;
  }
  const auto published = cv::makePtr<cv::aruco::Dictionary>(*opencv);
  published->bytesList = opencv->bytesList.clone();
  for (int id = 0; id < published->bytesList.rows; ++id) {
    cv::Mat bits = cv::aruco::Dictionary::getBitsFromByteList(opencv->bytesList.row(id), opencv->markerSize);
    cv::rotate(bits, bits, cv::ROTATE_180);
    cv::aruco::Dictionary::getByteListFromBits(bits).copyTo(published->bytesList.row(id));
  }
  return published;
}

}  // namespace floorloc
