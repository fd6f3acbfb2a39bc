// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

namespace floorloc {

/// One view of a floor: colour, and what a registered range sensor saw of the same pixels, if there is one.
struct SurfaceImage {
  cv::Mat color;      ///< CV_8UC3, BGR
  cv::Mat depth_mm;   ///< CV_16UC1 of the same size, millimetres, 0: hole; empty: no range sensor
  cv::Mat intensity;  ///< CV_16UC1 of the same size, in the sensor's unit, void in holes; empty with depth_mm

  bool has_range() const { return !depth_mm.empty(); }

  /// Throws std::invalid_argument that says which image has the wrong type or size.
  void Check() const;
};

}  // namespace floorloc
