// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/export/export_nav2.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <string>

#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "mapbuilder/finished_map/mosaic_level.h"

namespace floorloc {
namespace {

constexpr double kMaxSide = 30000.0;

// Darker pixels are not floor: the mosaic is black there, apart from JPEG noise.
constexpr double kMinFloorGray = 6.0;

int CellOf(double coordinate_m, double origin_m, double resolution_m) {
  return static_cast<int>(std::floor((coordinate_m - origin_m) / resolution_m));
}

}  // namespace

OccupancyGrid MakeOccupancyGrid(const MapDatabase& map, double resolution_m) {
  const MosaicLevel level = ReadMosaicLevel(map, resolution_m);
  const RectM extent = map.ReadInfo().extent;
  if (std::max(extent.width_m(), extent.height_m()) / resolution_m > kMaxSide) {
    throw MapError("the grid would have more than 30000 cells a side; export it with a larger --resolution");
  }
  OccupancyGrid grid;
  grid.resolution_m = resolution_m;
  grid.lower_left_m = {extent.x_min, extent.y_min};
  const cv::Size size(std::max(1, static_cast<int>(std::ceil(extent.width_m() / resolution_m))),
                      std::max(1, static_cast<int>(std::ceil(extent.height_m() / resolution_m))));
  const double pixel_m = level.resolution_m();
  cv::Mat covered = cv::Mat::zeros(size, CV_32F);  // surveyed share of each cell
  const auto share = static_cast<float>(pixel_m * pixel_m / (resolution_m * resolution_m));
  for (const TileId& tile : level.tiles) {
    cv::Mat gray;
    cv::cvtColor(DecodeMosaicTile(map, level, tile), gray, cv::COLOR_BGR2GRAY);
    const double side_m = level.layout.TileSide(level.zoom);
    for (int v = 0; v < gray.rows; ++v) {
      const int y = CellOf((tile.y + 1) * side_m - (v + 0.5) * pixel_m, extent.y_min, resolution_m);
      for (int u = 0; u < gray.cols; ++u) {
        const int x = CellOf(tile.x * side_m + (u + 0.5) * pixel_m, extent.x_min, resolution_m);
        if (x >= 0 && y >= 0 && x < size.width && y < size.height && gray.at<std::uint8_t>(v, u) >= kMinFloorGray) {
          covered.at<float>(size.height - 1 - y, x) += share;
        }
      }
    }
  }
  grid.cells = cv::Mat(size, CV_8UC1, cv::Scalar(OccupancyGrid::kUnknown));
  grid.cells.setTo(OccupancyGrid::kFree, covered >= 0.5F);
  return grid;
}

void WriteNav2Map(const OccupancyGrid& grid, const std::filesystem::path& yaml) {
  if (yaml.extension() != ".yaml") {
    throw InputError(yaml, "does not end in .yaml as map servers expect; choose another name");
  }
  std::filesystem::path image = yaml;
  image.replace_extension(".pgm");
  std::string pgm = "P5\n" + std::to_string(grid.cells.cols) + " " + std::to_string(grid.cells.rows) + "\n255\n";
  for (int row = 0; row < grid.cells.rows; ++row) {
    pgm.append(grid.cells.ptr<char>(row), static_cast<std::size_t>(grid.cells.cols));
  }
  WriteFileAtomically(image, pgm);
  char text[512];
  // Unknown cells have an occupancy of (255 - 205) / 255 = 0.19608, so free_thresh must be below that.
  std::snprintf(text, sizeof(text),
                "mode: trinary\nresolution: %.9g\norigin: [%.12g, %.12g, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n"
                "free_thresh: 0.196\n",
                grid.resolution_m, grid.lower_left_m.x(), grid.lower_left_m.y());
  WriteFileAtomically(yaml, "image: \"" + image.filename().string() + "\"\n" + text);
}

}  // namespace floorloc
