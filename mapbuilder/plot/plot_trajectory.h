// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace floorloc {

/// One estimated pose and its error.
struct ErrorSample {
  double time_s = 0.0;  ///< from any origin
  Eigen::Vector2d estimate_m = Eigen::Vector2d::Zero();
  double error = 0.0;  ///< in the unit of the plot
};

struct ErrorPlot {
  std::string title;
  std::string unit;                          ///< of the errors, e.g. "mm"; may be empty
  std::vector<Eigen::Vector2d> reference_m;  ///< true positions, ordered by time
  std::vector<ErrorSample> samples;          ///< ordered by time; at least one
};

/// Draws the trajectory in the plane, coloured by error, with a scale bar and a legend, next to the error over time
/// with lines for its RMSE, mean and median. Returns CV_8UC3.
cv::Mat DrawErrorPlot(const ErrorPlot& plot);

/// Draws the plot into a PNG file. Throws InputError when the file cannot be written.
void WriteErrorPlot(const std::filesystem::path& file, const ErrorPlot& plot);

}  // namespace floorloc
