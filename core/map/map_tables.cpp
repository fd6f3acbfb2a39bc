// SPDX-License-Identifier: Apache-2.0
#include "core/map/map_tables.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "core/map/camera_mask_table.h"
#include "core/map/checked_row.h"
#include "core/map/content_hash.h"
#include "core/map/extractor_parameters.h"
#include "core/map/floor_lattice_table.h"
#include "core/map/floor_texture_table.h"
#include "core/map/map_contract.h"
#include "core/map/map_layers.h"

namespace floorloc {
namespace {

constexpr int kMaxInt = std::numeric_limits<int>::max();
constexpr double kMaxReal = std::numeric_limits<double>::max();

// Largest distance of a region of interest from the base frame's origin. Frames are processed cell by cell; a larger
// region is an error of units.
constexpr double kMaxRoiM = 50.0;

constexpr double kMaxResolutionM = 10.0;

DistortionModel ParseDistortionModel(const std::string& name) {
  for (const auto model :
       {DistortionModel::kPlumbBob, DistortionModel::kRationalPolynomial, DistortionModel::kEquidistant}) {
    if (name == ToString(model)) {
      return model;
    }
  }
  throw std::invalid_argument("unknown distortion model '" + name + "'");
}

FloorCamera ReadCamera(const CheckedRow& row) {
  constexpr int kMaxSidePx = 1 << 20;  // avoids overflow; CameraModel::Check() has the real limits
  FloorCamera c;
  c.camera.name = row.Text(1, "name");
  c.camera.width_px = row.Integer(2, "width_px", 1, kMaxSidePx);
  c.camera.height_px = row.Integer(3, "height_px", 1, kMaxSidePx);
  c.camera.fx = row.Real(4, "fx", 0.0, kMaxReal);
  c.camera.fy = row.Real(5, "fy", 0.0, kMaxReal);
  c.camera.cx = row.Real(6, "cx", -kMaxReal, kMaxReal);
  c.camera.cy = row.Real(7, "cy", -kMaxReal, kMaxReal);
  const std::size_t numbers = row.Bytes(9, "distortion").size() / sizeof(double);
  c.camera.distortion = row.Doubles(9, "distortion", numbers);
  const std::vector<double> homography = row.Doubles(10, "homography", 9);
  c.floor.base_from_pixel = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(homography.data());
  c.floor.roi = {row.Real(11, "roi_x_min", -kMaxRoiM, kMaxRoiM), row.Real(12, "roi_x_max", -kMaxRoiM, kMaxRoiM),
                 row.Real(13, "roi_y_min", -kMaxRoiM, kMaxRoiM), row.Real(14, "roi_y_max", -kMaxRoiM, kMaxRoiM)};
  c.floor.resolution_m = row.Real(15, "resolution_m", 0.0, kMaxResolutionM);
  try {
    c.camera.distortion_model = ParseDistortionModel(row.Text(8, "distortion_model"));
    c.Check();
  } catch (const std::invalid_argument& error) {
    row.Refuse(error.what());
  }
  return c;
}

std::vector<FloorCamera> ReadCameras(const SqliteConnection& connection) {
  SqliteStatement statement(connection,
                            "SELECT survey, name, width_px, height_px, fx, fy, cx, cy, distortion_model, distortion, "
                            "homography, roi_x_min, roi_x_max, roi_y_min, roi_y_max, resolution_m FROM camera "
                            "ORDER BY survey");
  std::vector<FloorCamera> cameras;
  while (statement.Step()) {
    const std::string name = "camera " + std::to_string(cameras.size());
    const CheckedRow row(connection, statement, name);
    if (row.Long(0, "survey") != static_cast<std::int64_t>(cameras.size())) {
      row.Refuse("the surveys are not numbered from 0 without a gap");
    }
    cameras.push_back(ReadCamera(row));
  }
  if (cameras.empty()) {
    ThrowDamaged(connection, "no camera");
  }
  return cameras;
}

// Fills in what the cameras are worth and what they were before.
void ReadCalibration(const SqliteConnection& connection, MapInfo* info) {
  constexpr double kMaxSigmaPx = 1e4;
  SqliteStatement statement(connection,
                            "SELECT survey, sigma_px, offset_sigma_m, given_fx, given_fy, given_cx, given_cy, "
                            "given_distortion, given_homography FROM calibration ORDER BY survey");
  while (statement.Step()) {
    const std::size_t survey = info->given_cameras.size();
    const CheckedRow row(connection, statement, "calibration " + std::to_string(survey));
    if (survey >= info->cameras.size() || row.Long(0, "survey") != static_cast<std::int64_t>(survey)) {
      row.Refuse("it does not belong to a camera");
    }
    FloorCamera& camera = info->cameras[survey];
    camera.camera.sigma_px = row.Real(1, "sigma_px", 0.0, kMaxSigmaPx);
    camera.floor.offset_sigma_m = row.Real(2, "offset_sigma_m", 0.0, kMaxRoiM);
    FloorCamera given = camera;
    given.camera.fx = row.Real(3, "given_fx", 0.0, kMaxReal);
    given.camera.fy = row.Real(4, "given_fy", 0.0, kMaxReal);
    given.camera.cx = row.Real(5, "given_cx", -kMaxReal, kMaxReal);
    given.camera.cy = row.Real(6, "given_cy", -kMaxReal, kMaxReal);
    given.camera.distortion = row.Doubles(7, "given_distortion", camera.camera.distortion.size());
    const std::vector<double> homography = row.Doubles(8, "given_homography", 9);
    given.floor.base_from_pixel = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(homography.data());
    given.camera.sigma_px = given.floor.offset_sigma_m = 0.0;
    try {
      given.Check();
    } catch (const std::invalid_argument& error) {
      row.Refuse(error.what());
    }
    info->given_cameras.push_back(given);
  }
  if (info->given_cameras.size() != info->cameras.size()) {
    ThrowDamaged(connection, "a camera has no row in calibration");
  }
}

std::vector<MapParent> ReadParents(const SqliteConnection& connection) {
  SqliteStatement statement(connection, "SELECT relation, id, content_version FROM parent ORDER BY rowid");
  std::vector<MapParent> parents;
  while (statement.Step()) {
    const CheckedRow row(connection, statement, "parent " + std::to_string(parents.size()));
    parents.push_back({row.Text(0, "relation"), row.Text(1, "id"), row.Text(2, "content_version")});
    if (parents.back().relation != "extends" && parents.back().relation != "merges") {
      row.Refuse("unknown relation");
    }
  }
  return parents;
}

ExtractorOptions ReadExtractor(const SqliteConnection& connection) {
  SqliteStatement parameter(connection, "SELECT name, value FROM extractor_parameter");
  std::map<std::string, std::string> parameters;
  while (parameter.Step()) {
    parameters[parameter.Text(0)] = parameter.Text(1);
  }
  try {
    return FromParameters(parameters);
  } catch (const std::invalid_argument& error) {
    ThrowDamaged(connection, error.what());
  }
}

// SQLite's check also bounds the nesting depth, so that later parsers may recurse.
void CheckJson(const SqliteConnection& connection) {
  SqliteStatement valid(connection, "SELECT json_valid(surveys_json), json_valid(report_json) FROM map");
  valid.Step();
  if (valid.Integer(0) != 1 || valid.Integer(1) != 1) {
    ThrowDamaged(connection, valid.Integer(0) != 1 ? "map: surveys_json is no JSON" : "map: report_json is no JSON");
  }
  SqliteStatement type(connection, "SELECT json_type(surveys_json), json_type(report_json) FROM map");
  type.Step();
  if (type.Text(0) != "array" || type.Text(1) != "object") {
    ThrowDamaged(connection, "map: surveys_json is no array or report_json no object");
  }
  SqliteStatement odd(connection,
                      "SELECT COUNT(*) FROM map, json_each(map.surveys_json) AS survey WHERE survey.type <> 'object'");
  if (odd.Step() && odd.Integer(0) > 0) {
    ThrowDamaged(connection, "map: a survey in surveys_json is no object");
  }
}

RectM ReadExtent(const CheckedRow& row, int first_column) {
  const RectM extent{row.Coordinate(first_column, "x_min"), row.Coordinate(first_column + 1, "x_max"),
                     row.Coordinate(first_column + 2, "y_min"), row.Coordinate(first_column + 3, "y_max")};
  if (extent.width_m() < 0.0 || extent.height_m() < 0.0) {
    row.Refuse("x_min exceeds x_max, or y_min y_max");
  }
  return extent;
}

struct MosaicColumns {
  MosaicLayout layout;
  RectM extent;
};

MosaicColumns ReadMosaicAndExtent(const SqliteConnection& connection) {
  SqliteStatement statement(
      connection, "SELECT mosaic_tile_px, mosaic_max_zoom, resolution_m, x_min, x_max, y_min, y_max FROM map");
  if (!statement.Step()) {
    ThrowDamaged(connection, "no map row");
  }
  constexpr int kMaxZoom = 30;
  constexpr double kMaxTileIndex = 1 << 30;
  const CheckedRow row(connection, statement, "map");
  MosaicColumns columns;
  columns.layout.tile_px = row.Integer(0, "mosaic_tile_px", 16, 4096);
  columns.layout.max_zoom = row.Integer(1, "mosaic_max_zoom", 0, kMaxZoom);
  columns.layout.resolution_m = row.Real(2, "resolution_m", 1e-9, kMaxResolutionM);
  columns.extent = ReadExtent(row, 3);
  const double farthest_m = std::max({std::abs(columns.extent.x_min), std::abs(columns.extent.x_max),
                                      std::abs(columns.extent.y_min), std::abs(columns.extent.y_max)});
  if (farthest_m / columns.layout.TileSide(columns.layout.max_zoom) > kMaxTileIndex) {
    row.Refuse("resolution_m is too small for the extent");
  }
  return columns;
}

Eigen::Matrix3d ReadCovariance(const CheckedRow& row, int column) {
  const std::vector<double> c = row.Doubles(column, "covariance", 6);
  Eigen::Matrix3d covariance;
  covariance << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  // Scaled to a correlation matrix, so that the units do not matter.
  const Eigen::Vector3d scale = covariance.diagonal().cwiseMax(0.0).cwiseSqrt().cwiseInverse();
  const Eigen::Matrix3d correlation = scale.asDiagonal() * covariance * scale.asDiagonal();
  if (!correlation.allFinite() || correlation.llt().info() != Eigen::Success) {
    row.Refuse("covariance is not positive definite");
  }
  return covariance;
}

}  // namespace

MapInfo ReadInfoTables(const SqliteConnection& connection) {
  SqliteStatement statement(connection,
                            "SELECT builder_version, id, content_version, name, created, frame, resolution_m, x_min, "
                            "x_max, y_min, y_max, area_m2, surveys_json, report_json FROM map");
  if (!statement.Step()) {
    ThrowDamaged(connection, "no map row");
  }
  const CheckedRow row(connection, statement, "map");
  MapInfo info;
  info.format_version = ReadFormatVersion(connection);
  info.builder_version = row.Text(0, "builder_version");
  info.id = row.Text(1, "id");
  info.content_version = row.Text(2, "content_version");
  if (!IsSha256(info.content_version)) {  // it is used in HTTP headers and file names
    row.Refuse("content_version is no SHA-256 in hex");
  }
  info.name = row.Text(3, "name");
  info.created = row.Text(4, "created");
  if (row.Text(5, "frame") != "map") {
    row.Refuse("frame is not 'map'");
  }
  info.resolution_m = ReadMosaicAndExtent(connection).layout.resolution_m;
  info.extent = ReadExtent(row, 7);
  info.area_m2 = row.Real(11, "area_m2", 0.0, 4.0 * kMaxMapCoordinateM * kMaxMapCoordinateM);
  info.surveys_json = row.Text(12, "surveys_json");
  info.report_json = row.Text(13, "report_json");
  CheckJson(connection);
  info.extractor = ReadExtractor(connection);
  info.cameras = ReadCameras(connection);
  info.parents = ReadParents(connection);
  info.layers = ReadLayers(connection);
  if (HasLayer(info.layers, kCalibrationLayer)) {
    ReadCalibration(connection, &info);
  }
  if (HasLayer(info.layers, kCameraMaskLayer)) {
    info.masks = ReadCameraMasks(connection, info);
  }
  if (HasLayer(info.layers, kFloorLatticeLayer)) {
    info.lattices = ReadFloorLattices(connection);
  }
  if (HasLayer(info.layers, kFloorTextureLayer)) {
    info.floor_textures = ReadFloorTextures(connection, info);
  }
  return info;
}

std::vector<MapFrame> ReadFrameTable(const SqliteConnection& connection, const MapInfo& info) {
  constexpr double kMaxGain = 1e6;
  // The extent is that of the frames' floor: a frame beyond rounding errors outside of it does not belong to this map.
  constexpr double kSlackM = 1.0;
  const RectM floor{info.extent.x_min - kSlackM, info.extent.x_max + kSlackM, info.extent.y_min - kSlackM,
                    info.extent.y_max + kSlackM};
  SqliteStatement statement(connection,
                            "SELECT id, survey, stamp_ns, filename, x, y, yaw, gain, odom_x, odom_y, odom_yaw FROM "
                            "frame ORDER BY id");
  std::vector<MapFrame> frames;
  while (statement.Step()) {
    const CheckedRow row(connection, statement, "frame " + std::to_string(frames.size()));
    if (row.Long(0, "id") != static_cast<std::int64_t>(frames.size())) {
      row.Refuse("the frames are not numbered from 0 without a gap");
    }
    MapFrame frame;
    frame.survey = row.Integer(1, "survey", 0, static_cast<std::int64_t>(info.cameras.size()) - 1);
    frame.stamp_ns = row.Long(2, "stamp_ns");
    frame.filename = row.Text(3, "filename");
    frame.map_from_base = row.Pose(4, "");
    const RectM& roi = info.cameras[static_cast<std::size_t>(frame.survey)].floor.roi;
    if (!floor.Contains(frame.map_from_base * roi.Center())) {
      row.Refuse("it does not look at the surveyed floor");
    }
    frame.gain = row.Real(7, "gain", 1.0 / kMaxGain, kMaxGain);
    if (!statement.IsNull(8) || !statement.IsNull(9) || !statement.IsNull(10)) {
      frame.odom_from_base = row.Pose(8, "odom_");
    }
    frames.push_back(std::move(frame));
  }
  return frames;
}

std::vector<MapLink> ReadLinkTable(const SqliteConnection& connection, const MapInfo& info, int frames) {
  const double longest_m = info.extent.width_m() + info.extent.height_m() + 2.0 * kMaxRoiM;
  SqliteStatement statement(connection,
                            "SELECT first, second, x, y, yaw, covariance, inliers, rms_m, residual_sigma FROM link "
                            "ORDER BY first, second");
  std::vector<MapLink> links;
  while (statement.Step()) {
    const CheckedRow row(connection, statement, "link " + std::to_string(links.size()));
    MapLink link;
    link.first = row.Integer(0, "first", 0, frames - 1);
    link.second = row.Integer(1, "second", 0, frames - 1);
    if (link.first == link.second) {
      row.Refuse("it joins a frame with itself");
    }
    link.first_from_second = row.Pose(2, "");
    if (link.first_from_second.translation().norm() > longest_m) {
      row.Refuse("it is longer than the map");
    }
    link.covariance = ReadCovariance(row, 5);
    link.inliers = row.Integer(6, "inliers", 0, kMaxInt);
    link.rms_m = row.Real(7, "rms_m", 0.0, kMaxMapCoordinateM);
    link.residual_sigma = row.Real(8, "residual_sigma", 0.0, kMaxReal);
    links.push_back(link);
  }
  return links;
}

MosaicLayout ReadMosaicColumns(const SqliteConnection& connection) { return ReadMosaicAndExtent(connection).layout; }

std::vector<TileId> ReadMosaicTileIds(const SqliteConnection& connection, int zoom) {
  const auto [layout, extent] = ReadMosaicAndExtent(connection);
  SqliteStatement statement(connection, "SELECT x, y FROM mosaic_tile WHERE z = ? ORDER BY x, y");
  statement.Bind(zoom);
  std::vector<TileId> tiles;
  if (zoom < 0 || zoom > layout.max_zoom) {
    return tiles;
  }
  // A tile next to the extent is a rounding error, one farther away does not belong to this map.
  const double side_m = layout.TileSide(zoom);
  const auto first = [&](double low_m) { return static_cast<std::int64_t>(std::floor(low_m / side_m)) - 1; };
  const auto last = [&](double high_m) { return static_cast<std::int64_t>(std::floor(high_m / side_m)) + 1; };
  while (statement.Step()) {
    const CheckedRow row(connection, statement,
                         "mosaic tile " + std::to_string(tiles.size()) + " of level " + std::to_string(zoom));
    tiles.push_back({zoom, row.Integer(0, "x", first(extent.x_min), last(extent.x_max)),
                     row.Integer(1, "y", first(extent.y_min), last(extent.y_max))});
  }
  return tiles;
}

std::optional<std::vector<std::uint8_t>> ReadTile(const SqliteConnection& connection, const TileId& tile) {
  SqliteStatement row(connection, "SELECT jpeg, checksum FROM mosaic_tile WHERE z = ? AND x = ? AND y = ?");
  row.Bind(tile.z).Bind(tile.x).Bind(tile.y);
  if (!row.Step()) {
    return std::nullopt;
  }
  const CheckedRow checked(
      connection, row,
      "mosaic tile " + std::to_string(tile.z) + "/" + std::to_string(tile.x) + "/" + std::to_string(tile.y));
  Blob jpeg = checked.Bytes(0, "jpeg");
  ContentHash hash;
  if (hash.Add(jpeg).Checksum() != checked.Long(1, "checksum")) {
    checked.Refuse("its checksum differs");
  }
  return jpeg;
}

}  // namespace floorloc
