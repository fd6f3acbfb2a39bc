// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/export/export_mosaic.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "mapbuilder/finished_map/mosaic_level.h"

namespace floorloc {
namespace {

constexpr double kMaxSidePx = 30000.0;

// Whole tiles reach beyond the floor. What is left holds the surveyed extent, and every pixel that is not black.
void CropToFloor(const RectM& surveyed, MosaicImage* mosaic) {
  const RectM whole = mosaic->extent;
  const cv::Size size = mosaic->bgr.size();
  const double x_step_m = whole.width_m() / size.width;
  const double y_step_m = whole.height_m() / size.height;
  const auto outwards = [](double low, double high, int limit) {  // a little inwards, so that rounding adds no pixel
    constexpr double kSlack = 1e-6;
    const int first = std::clamp(static_cast<int>(std::floor(low + kSlack)), 0, limit - 1);
    return cv::Range(first, std::clamp(static_cast<int>(std::ceil(high - kSlack)), first + 1, limit));
  };
  const cv::Range columns =
      outwards((surveyed.x_min - whole.x_min) / x_step_m, (surveyed.x_max - whole.x_min) / x_step_m, size.width);
  const cv::Range rows =
      outwards((whole.y_max - surveyed.y_max) / y_step_m, (whole.y_max - surveyed.y_min) / y_step_m, size.height);
  const cv::Rect kept =
      cv::Rect(columns.start, rows.start, columns.size(), rows.size()) | cv::boundingRect(SurveyedPixels(mosaic->bgr));
  mosaic->bgr = mosaic->bgr(kept).clone();
  mosaic->extent = {whole.x_min + kept.x * x_step_m, whole.x_min + (kept.x + kept.width) * x_step_m,
                    whole.y_max - (kept.y + kept.height) * y_step_m, whole.y_max - kept.y * y_step_m};
}

}  // namespace

MosaicImage ExportMosaic(const MapDatabase& map, double resolution_m) {
  const MosaicLevel level = ReadMosaicLevel(map, resolution_m);
  const double wanted_m = resolution_m > 0.0 ? resolution_m : level.layout.resolution_m;
  const RectM grid = level.Extent();
  // The level can have up to twice the requested pixels per side; more in a damaged map whose tiles are far apart.
  const double level_px = std::max(level.columns(), level.rows()) * static_cast<double>(level.layout.tile_px);
  if (grid.width_m() / wanted_m > kMaxSidePx || grid.height_m() / wanted_m > kMaxSidePx ||
      level_px > 2.0 * kMaxSidePx + level.layout.tile_px) {
    throw MapError("the mosaic would have more than 30000 pixels a side; export it with a larger --resolution, e.g. " +
                   std::to_string(std::max(grid.width_m(), grid.height_m()) / kMaxSidePx) + ", or with --geotiff");
  }
  const int tile_px = level.layout.tile_px;
  cv::Mat whole = cv::Mat::zeros(level.rows() * tile_px, level.columns() * tile_px, CV_8UC3);
  for (const TileId& tile : level.tiles) {
    DecodeMosaicTile(map, level, tile).copyTo(whole(cv::Rect(level.Corner(tile), cv::Size(tile_px, tile_px))));
  }
  MosaicImage result{whole, level.resolution_m(), grid};
  if (std::abs(wanted_m / level.resolution_m() - 1.0) > 1e-6) {
    // At least a pixel, however coarse it is wanted.
    const cv::Size size(std::max(1, static_cast<int>(std::lround(grid.width_m() / wanted_m))),
                        std::max(1, static_cast<int>(std::lround(grid.height_m() / wanted_m))));
    cv::resize(whole, result.bgr, size, 0, 0, wanted_m > level.resolution_m() ? cv::INTER_AREA : cv::INTER_CUBIC);
    result.resolution_m = grid.width_m() / size.width;
  }
  CropToFloor(map.ReadInfo().extent, &result);
  return result;
}

}  // namespace floorloc
