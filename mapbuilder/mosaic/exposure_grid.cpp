// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/mosaic/exposure_grid.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "core/io/image.h"
#include "mapbuilder/batch/parallel.h"

namespace floorloc {
namespace {

// Downscaling of the raw images before colours are measured.
constexpr double kShrink = 8.0;

// Positions of the cell centres in the downscaled raw image. Where rows were while they were read out is left out: at
// 0.3 m/s and 33 ms the first and the last one are off by a fifth of a cell of 24 mm, light changes little over that,
// and texture averages out over the cells of a link.
cv::Mat SmallPixels(const ExposureGrid& grid, const FloorCamera& camera) {
  cv::Mat pixels(grid.valid.size(), CV_32FC2);
  for (int v = 0; v < pixels.rows; ++v) {
    for (int u = 0; u < pixels.cols; ++u) {
      const Eigen::Vector2d raw = camera.RawPixelFromFloor(grid.BaseFromCell(u, v));
      const Eigen::Vector2d px = grid.valid.at<std::uint8_t>(v, u) == 0
                                     ? Eigen::Vector2d::Zero()
                                     : Eigen::Vector2d((raw.array() + 0.5) / kShrink - 0.5);
      pixels.at<cv::Vec2f>(v, u) = {static_cast<float>(px.x()), static_cast<float>(px.y())};
    }
  }
  return pixels;
}

}  // namespace

ExposureGrid::ExposureGrid(const LoadedSurvey& survey) : ground(survey.rectifier->grid()) {
  const cv::Mat& mask = survey.rectifier->mask();
  valid = cv::Mat::zeros(std::max(1, mask.rows / kCellPx), std::max(1, mask.cols / kCellPx), CV_8UC1);
  for (int v = 0; v < valid.rows; ++v) {
    for (int u = 0; u < valid.cols; ++u) {
      const cv::Rect cell = cv::Rect(u * kCellPx, v * kCellPx, kCellPx, kCellPx) & cv::Rect(cv::Point(), mask.size());
      valid.at<std::uint8_t>(v, u) = cv::countNonZero(mask(cell)) == cell.area() ? 255 : 0;
    }
  }
}

std::vector<ExposureGrid> MakeExposureGrids(const std::vector<LoadedSurvey>& surveys) {
  std::vector<ExposureGrid> grids;
  for (const LoadedSurvey& survey : surveys) {
    grids.emplace_back(survey);
  }
  return grids;
}

std::vector<cv::Mat> MeasureCellColors(const CellColorInput& input) {
  const std::vector<ExposureGrid> grids = MakeExposureGrids(input.surveys);
  std::vector<cv::Mat> pixels;
  for (std::size_t s = 0; s < grids.size(); ++s) {
    pixels.push_back(SmallPixels(grids[s], input.surveys[s].survey.camera));
  }
  std::vector<cv::Mat> cell_colors(input.frames.size());
  ParallelFor(static_cast<int>(cell_colors.size()), input.run.threads, [&](int index) {
    const auto i = static_cast<std::size_t>(index);
    if (!input.map_from_base[i]) {
      return;
    }
    const auto s = static_cast<std::size_t>(input.frames[i].survey);
    const Survey& survey = input.surveys[s].survey;
    const CameraModel& camera = survey.camera.camera;
    cv::Mat small = ReadSmallColorImage(survey.ImagePath(input.frames[i].info), camera.width_px, camera.height_px);
    cv::blur(small, small, cv::Size(3, 3));
    cv::remap(small, cell_colors[i], pixels[s], cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    cell_colors[i] = cv::max(cell_colors[i], 1);  // zero means invalid
    cell_colors[i].setTo(cv::Scalar::all(0), grids[s].valid == 0);
  });
  return cell_colors;
}

}  // namespace floorloc
