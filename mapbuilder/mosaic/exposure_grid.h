// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "mapbuilder/batch/run_options.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

/// Coarse grid on which the colours of a survey's frames are measured; a cell has kCellPx pixels of the rectified image
/// a side.
struct ExposureGrid {
  static constexpr int kCellPx = 24;

  GroundGrid ground;
  cv::Mat valid;  ///< CV_8UC1 per cell, 255 where the whole cell shows floor

  explicit ExposureGrid(const LoadedSurvey& survey);

  /// Centre of a cell, base frame.
  Eigen::Vector2d BaseFromCell(double u, double v) const {
    return ground.BaseFromPixel((u + 0.5) * kCellPx - 0.5, (v + 0.5) * kCellPx - 0.5);
  }
  Eigen::Vector2d CellFromBase(const Eigen::Vector2d& p) const {
    return (ground.PixelFromBase(p).array() + 0.5) / kCellPx - 0.5;
  }
};

/// One grid per survey.
std::vector<ExposureGrid> MakeExposureGrids(const std::vector<LoadedSurvey>& surveys);

struct CellColorInput {
  const std::vector<BuildFrame>& frames;
  const std::vector<LoadedSurvey>& surveys;
  const std::vector<std::optional<Pose2>>& map_from_base;
  RunOptions run = {};
};

/// Colour of every cell of every frame: CV_8UC3 of its survey's grid, zero where invalid; empty for frames that were
/// not placed. Throws InputError for an unreadable image.
std::vector<cv::Mat> MeasureCellColors(const CellColorInput& input);

}  // namespace floorloc
