// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/mosaic/frame_light.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "core/io/image.h"
#include "mapbuilder/batch/parallel.h"

namespace floorloc {
namespace {

// Of the pictures that light is measured in.
constexpr double kShrink = 8.0;

// Where the middle of each cell lies in a shrunken raw picture.
cv::Mat SmallPixels(const LightGrid& grid, const FloorCamera& camera) {
  cv::Mat pixels(grid.seen.size(), CV_32FC2);
  for (int v = 0; v < pixels.rows; ++v) {
    for (int u = 0; u < pixels.cols; ++u) {
      const Eigen::Vector2d raw = camera.RawPixelFromFloor(grid.BaseFromCell(u, v));
      const Eigen::Vector2d px = grid.seen.at<std::uint8_t>(v, u) == 0
                                     ? Eigen::Vector2d::Zero()
                                     : Eigen::Vector2d((raw.array() + 0.5) / kShrink - 0.5);
      pixels.at<cv::Vec2f>(v, u) = {static_cast<float>(px.x()), static_cast<float>(px.y())};
    }
  }
  return pixels;
}

}  // namespace

LightGrid::LightGrid(const LoadedSurvey& survey) : ground(survey.rectifier->grid()) {
  const cv::Mat mask = survey.FloorMask();
  seen = cv::Mat::zeros(std::max(1, mask.rows / kCellPx), std::max(1, mask.cols / kCellPx), CV_8UC1);
  for (int v = 0; v < seen.rows; ++v) {
    for (int u = 0; u < seen.cols; ++u) {
      const cv::Rect cell = cv::Rect(u * kCellPx, v * kCellPx, kCellPx, kCellPx) & cv::Rect(cv::Point(), mask.size());
      seen.at<std::uint8_t>(v, u) = cv::countNonZero(mask(cell)) == cell.area() ? 255 : 0;
    }
  }
}

std::vector<LightGrid> MakeLightGrids(const std::vector<LoadedSurvey>& surveys) {
  std::vector<LightGrid> grids;
  for (const LoadedSurvey& survey : surveys) {
    grids.emplace_back(survey);
  }
  return grids;
}

std::vector<cv::Mat> MeasureLight(const LightInput& input) {
  const std::vector<LightGrid> grids = MakeLightGrids(input.surveys);
  std::vector<cv::Mat> pixels;
  for (std::size_t s = 0; s < grids.size(); ++s) {
    pixels.push_back(SmallPixels(grids[s], input.surveys[s].survey.camera));
  }
  std::vector<cv::Mat> light(input.frames.size());
  ParallelFor(static_cast<int>(light.size()), input.threads, [&](int index) {
    const auto i = static_cast<std::size_t>(index);
    if (!input.map_from_base[i]) {
      return;
    }
    const auto s = static_cast<std::size_t>(input.frames[i].survey);
    const Survey& survey = input.surveys[s].survey;
    const CameraModel& camera = survey.camera.camera;
    cv::Mat small = ReadSmallColorImage(survey.ImagePath(input.frames[i].info), camera.width_px, camera.height_px);
    cv::blur(small, small, cv::Size(3, 3));
    cv::remap(small, light[i], pixels[s], cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    light[i] = cv::max(light[i], 1);  // zero says unseen
    light[i].setTo(cv::Scalar::all(0), grids[s].seen == 0);
  });
  return light;
}

}  // namespace floorloc
