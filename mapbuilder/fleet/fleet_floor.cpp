// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/fleet/fleet_floor.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/io/input_error.h"
#include "mapbuilder/finished_map/mosaic_level.h"

namespace floorloc {
namespace {

using nlohmann::json;

constexpr int kCellPx = 16;  // of the mosaic, per cell of FleetFloor::surveyed

InputError MapProblem(const std::string& name, const std::string& what) { return {"map " + name, what}; }

std::string ReadyMaps(const json& maps) {
  std::string names;
  for (const json& map : maps) {
    if (map.value("status", "") == "ready") {
      names += (names.empty() ? "" : ", ") + map.value("name", "");
    }
  }
  return names;
}

// The tiles that are used, inclusive.
struct TileRange {
  int x0 = 0, x1 = 0;
  int y0 = 0, y1 = 0;

  cv::Size size() const { return {x1 - x0 + 1, y1 - y0 + 1}; }
};

// All tiles of the extent, or those about its middle.
TileRange ChooseTiles(const RectM& extent, double tile_m, double max_area_m2, bool* whole) {
  const double share = std::sqrt(std::min(1.0, max_area_m2 / (extent.width_m() * extent.height_m())));
  *whole = share == 1.0;
  const Eigen::Vector2d middle = extent.Center();
  const Eigen::Vector2d half = 0.5 * share * Eigen::Vector2d(extent.width_m(), extent.height_m());
  const auto tile_at = [&](double coordinate_m) { return static_cast<int>(std::floor(coordinate_m / tile_m)); };
  return {tile_at(middle.x() - half.x()), tile_at(middle.x() + half.x()), tile_at(middle.y() - half.y()),
          tile_at(middle.y() + half.y())};
}

// Pastes the tiles into one image. Returns how many there are.
int FetchTiles(client::Client& server, const std::string& name, const MosaicLayout& layout, const TileRange& range,
               cv::Mat* image) {
  int count = 0;
  for (int y = range.y0; y <= range.y1; ++y) {
    for (int x = range.x0; x <= range.x1; ++x) {
      const auto jpeg = server.GetTile(name, {layout.max_zoom, x, y});
      if (!jpeg) {
        continue;
      }
      const cv::Mat tile = DecodeMosaicTile(std::vector<std::uint8_t>(jpeg->begin(), jpeg->end()), layout.tile_px);
      tile.copyTo((*image)(
          cv::Rect((x - range.x0) * layout.tile_px, (range.y1 - y) * layout.tile_px, layout.tile_px, layout.tile_px)));
      ++count;
    }
  }
  return count;
}

}  // namespace

json ChooseServedMap(client::Client& server, const std::string& name) {
  const json list = server.ListMaps();
  const std::string ready = ReadyMaps(list.at("maps"));
  if (name.empty() && (ready.empty() || ready.find(',') != std::string::npos)) {
    throw InputError("server", ready.empty() ? "it serves no map; build one and put it into the server's folder"
                                             : "it serves several maps (" + ready + "); choose one with --map");
  }
  const std::string wanted = name.empty() ? ready : name;
  for (const json& map : list.at("maps")) {
    if (map.value("name", "") == wanted) {
      if (map.value("status", "") != "ready") {
        throw MapProblem(wanted, "the server could not load it: " + map.value("error", ""));
      }
      return server.GetMap(wanted);
    }
  }
  throw MapProblem(wanted, "the server has no such map; it has " + (ready.empty() ? std::string("none") : ready));
}

FleetFloor FetchFloor(client::Client& server, const json& map, double max_area_m2) {
  const std::string name = map.at("name").get<std::string>();
  if (!map.contains("mosaic") || !map.at("mosaic").is_object()) {
    throw MapProblem(name, "it has no mosaic to take images of; build it again");
  }
  const json& mosaic = map.at("mosaic");
  const MosaicLayout layout = {mosaic.at("tile_px").get<int>(), mosaic.at("max_zoom").get<int>(),
                               mosaic.at("resolution").get<double>()};
  const json& e = map.at("extent");
  const RectM extent = {e.at("x_min").get<double>(), e.at("x_max").get<double>(), e.at("y_min").get<double>(),
                        e.at("y_max").get<double>()};
  FleetFloor floor;
  const double tile_m = layout.TileSide(layout.max_zoom);
  const TileRange range = ChooseTiles(extent, tile_m, max_area_m2, &floor.whole);
  floor.texture.resolution_m = layout.resolution_m;
  floor.texture.bgr = cv::Mat::zeros(range.size() * layout.tile_px, CV_8UC3);
  floor.corner_m = Eigen::Vector2d(range.x0, range.y0) * tile_m;
  if (FetchTiles(server, name, layout, range, &floor.texture.bgr) == 0) {
    throw MapProblem(name, "it has no mosaic to take images of; build it again");
  }
  cv::Mat share;
  cv::resize(SurveyedPixels(floor.texture.bgr), share, floor.texture.bgr.size() / kCellPx, 0.0, 0.0, cv::INTER_AREA);
  floor.surveyed = share > 250;
  floor.cell_m = kCellPx * layout.resolution_m;
  return floor;
}

}  // namespace floorloc
