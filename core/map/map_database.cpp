// SPDX-License-Identifier: Apache-2.0
#include "core/map/map_database.h"

#include <cmath>
#include <map>
#include <mutex>
#include <string>

#include "core/map/content_hash.h"
#include "core/map/extractor_parameters.h"
#include "core/map/keypoint_blobs.h"
#include "core/map/map_contract.h"

namespace floorloc {
namespace {

constexpr int kMaxBlobBytes = 512 << 20;
constexpr int kMaxDescriptorLength = 4096;

SqliteConnection OpenChecked(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) {
    throw MapError(file.string() + " does not exist or is no file; give the path of a .floormap file");
  }
  SqliteConnection connection(file, SqliteConnection::Mode::kReadOnly);
  // A map comes from outside: nothing in it may run code or exceed its limits (SQLite, "Defense Against The Dark
  // Arts").
  sqlite3_db_config(connection.get(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(connection.get(), SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_limit(connection.get(), SQLITE_LIMIT_LENGTH, kMaxBlobBytes);
  connection.Execute("PRAGMA cell_size_check = ON; PRAGMA mmap_size = 0;");
  return connection;
}

std::int64_t Pragma(const SqliteConnection& connection, const char* name) {
  SqliteStatement statement(connection, std::string("PRAGMA ") + name);
  return statement.Step() ? statement.Integer(0) : 0;
}

DistortionModel ParseDistortionModel(const std::string& name) {
  for (const auto model :
       {DistortionModel::kPlumbBob, DistortionModel::kRationalPolynomial, DistortionModel::kEquidistant}) {
    if (name == ToString(model)) {
      return model;
    }
  }
  throw std::invalid_argument("unknown distortion model '" + name + "'");
}

}  // namespace

struct MapDatabase::Impl {
  explicit Impl(const std::filesystem::path& file) : connection(OpenChecked(file)) { CheckContract(); }

  SqliteConnection connection;
  mutable std::mutex mutex;

  [[noreturn]] void Damaged(const std::string& what) const {
    throw MapError(connection.file().string() + " is damaged (" + what + "); restore it from a copy or build it again");
  }
  void CheckContract() const;
  MapInfo ReadInfo() const;
  std::vector<FloorCamera> ReadCameras() const;
  FloorCamera ReadCamera(const SqliteStatement& row) const;
  std::vector<MapParent> ReadParents() const;
  std::vector<MapFrame> ReadFrames() const;
  std::vector<MapLink> ReadLinks() const;
  MosaicLayout ReadMosaicLayout() const;
  MapKeypoints ReadKeypoints() const;
};

void MapDatabase::Impl::CheckContract() const {
  if (Pragma(connection, "application_id") != kMapApplicationId) {
    throw MapError(connection.file().string() +
                   " is not a floorloc map; give a .floormap file that floorloc-mapbuilder wrote");
  }
  const std::int64_t version = Pragma(connection, "user_version");
  if (version != kMapFormatVersion) {
    throw MapError(connection.file().string() + " has format version " + std::to_string(version) +
                   " but this program reads version " + std::to_string(kMapFormatVersion) +
                   "; build the map again or use the matching version of floorloc");
  }
  SqliteStatement check(connection, "PRAGMA quick_check(1)");
  if (!check.Step() || check.Text(0) != "ok") {
    Damaged("SQLite's quick_check failed");
  }
}

std::vector<FloorCamera> MapDatabase::Impl::ReadCameras() const {
  SqliteStatement row(connection, "SELECT * FROM camera ORDER BY survey");
  std::vector<FloorCamera> cameras;
  while (row.Step()) {
    if (row.Integer(0) != static_cast<std::int64_t>(cameras.size())) {
      Damaged("numbers of the surveys");
    }
    cameras.push_back(ReadCamera(row));
  }
  if (cameras.empty()) {
    Damaged("no camera");
  }
  return cameras;
}

FloorCamera MapDatabase::Impl::ReadCamera(const SqliteStatement& row) const {
  FloorCamera c;
  c.camera.name = row.Text(1);
  c.camera.width_px = static_cast<int>(row.Integer(2));
  c.camera.height_px = static_cast<int>(row.Integer(3));
  c.camera.fx = row.Real(4);
  c.camera.fy = row.Real(5);
  c.camera.cx = row.Real(6);
  c.camera.cy = row.Real(7);
  c.camera.distortion_model = ParseDistortionModel(row.Text(8));
  c.camera.distortion = UnpackDoubles(row.Bytes(9));
  const std::vector<double> homography = UnpackDoubles(row.Bytes(10));
  if (homography.size() != 9) {
    Damaged("camera homography");
  }
  c.floor.base_from_pixel = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(homography.data());
  c.floor.roi = {row.Real(11), row.Real(12), row.Real(13), row.Real(14)};
  c.floor.resolution_m = row.Real(15);
  c.Check();
  return c;
}

MapInfo MapDatabase::Impl::ReadInfo() const {
  try {
    MapInfo info;
    SqliteStatement row(connection,
                        "SELECT builder_version, id, content_version, name, created, resolution_m, x_min, x_max, "
                        "y_min, y_max, area_m2, surveys_json, report_json FROM map");
    if (!row.Step()) {
      Damaged("no map row");
    }
    info.format_version = kMapFormatVersion;
    info.builder_version = row.Text(0);
    info.id = row.Text(1);
    info.content_version = row.Text(2);
    info.name = row.Text(3);
    info.created = row.Text(4);
    info.resolution_m = row.Real(5);
    info.extent = {row.Real(6), row.Real(7), row.Real(8), row.Real(9)};
    info.area_m2 = row.Real(10);
    info.surveys_json = row.Text(11);
    info.report_json = row.Text(12);
    std::map<std::string, std::string> parameters;
    SqliteStatement parameter(connection, "SELECT name, value FROM extractor_parameter");
    while (parameter.Step()) {
      parameters[parameter.Text(0)] = parameter.Text(1);
    }
    info.extractor = FromParameters(parameters);
    info.cameras = ReadCameras();
    info.parents = ReadParents();
    if (!(info.resolution_m > 0.0) || !std::isfinite(info.area_m2)) {
      Damaged("resolution or area");
    }
    return info;
  } catch (const std::invalid_argument& error) {
    Damaged(error.what());
  }
}

std::vector<MapParent> MapDatabase::Impl::ReadParents() const {
  SqliteStatement row(connection, "SELECT relation, id, content_version FROM parent ORDER BY rowid");
  std::vector<MapParent> parents;
  while (row.Step()) {
    parents.push_back({row.Text(0), row.Text(1), row.Text(2)});
  }
  return parents;
}

std::vector<MapFrame> MapDatabase::Impl::ReadFrames() const {
  SqliteStatement row(connection,
                      "SELECT id, survey, stamp_ns, filename, x, y, yaw, gain, odom_x, odom_y, odom_yaw FROM frame "
                      "ORDER BY id");
  std::vector<MapFrame> frames;
  while (row.Step()) {
    if (row.Integer(0) != static_cast<std::int64_t>(frames.size())) {
      Damaged("numbers of the frames");
    }
    MapFrame frame{
        row.Integer(2), row.Text(3), Pose2(row.Real(4), row.Real(5), row.Real(6)), static_cast<int>(row.Integer(1)),
        row.Real(7),    std::nullopt};
    if (!row.IsNull(8)) {
      frame.odom_from_base = Pose2(row.Real(8), row.Real(9), row.Real(10));
    }
    frames.push_back(std::move(frame));
  }
  return frames;
}

std::vector<MapLink> MapDatabase::Impl::ReadLinks() const {
  SqliteStatement count(connection, "SELECT COUNT(*) FROM frame");
  const std::int64_t frames = count.Step() ? count.Integer(0) : 0;
  SqliteStatement row(connection,
                      "SELECT first, second, x, y, yaw, covariance, inliers, rms_m, residual_sigma FROM link "
                      "ORDER BY first, second");
  std::vector<MapLink> links;
  while (row.Step()) {
    const std::vector<double> c = UnpackDoubles(row.Bytes(5));
    if (row.Integer(0) < 0 || row.Integer(1) < 0 || row.Integer(0) >= frames || row.Integer(1) >= frames ||
        c.size() != 6) {
      Damaged("links");
    }
    MapLink link{static_cast<int>(row.Integer(0)), static_cast<int>(row.Integer(1)),
                 Pose2(row.Real(2), row.Real(3), row.Real(4))};
    link.covariance << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
    link.inliers = static_cast<int>(row.Integer(6));
    link.rms_m = row.Real(7);
    link.residual_sigma = row.Real(8);
    links.push_back(link);
  }
  return links;
}

MosaicLayout MapDatabase::Impl::ReadMosaicLayout() const {
  SqliteStatement row(connection, "SELECT mosaic_tile_px, mosaic_max_zoom, resolution_m FROM map");
  if (!row.Step()) {
    Damaged("no map row");
  }
  MosaicLayout layout;
  layout.tile_px = static_cast<int>(row.Integer(0));
  layout.max_zoom = static_cast<int>(row.Integer(1));
  layout.resolution_m = row.Real(2);
  constexpr int kMaxZoom = 30;
  if (layout.tile_px < 16 || layout.tile_px > 4096 || layout.max_zoom < 0 || layout.max_zoom > kMaxZoom) {
    Damaged("mosaic layout");
  }
  return layout;
}

MapKeypoints MapDatabase::Impl::ReadKeypoints() const {
  SqliteStatement header(connection, "SELECT descriptor_type, descriptor_length, keypoint_tile_m FROM map");
  if (!header.Step()) {
    Damaged("no map row");
  }
  const bool binary = header.Text(0) == "binary";
  const std::int64_t length = header.Integer(1);
  const double side_m = header.Real(2);
  if (length < 0 || length > kMaxDescriptorLength || !(side_m > 0.0)) {
    Damaged("descriptor layout");
  }
  MapKeypoints keypoints;
  keypoints.descriptors = cv::Mat(0, static_cast<int>(length), binary ? CV_8U : CV_32F);
  SqliteStatement sum(connection, "SELECT COALESCE(SUM(LENGTH(angle) / 4), 0) FROM keypoint_tile");
  sum.Step();
  const auto total = static_cast<std::size_t>(sum.Integer(0));  // from real lengths, so never more than the file holds
  keypoints.keypoints.reserve(total);
  keypoints.observations.reserve(total);
  keypoints.distinctiveness.reserve(total);
  keypoints.last_survey.reserve(total);
  keypoints.descriptors.reserve(total);
  SqliteStatement row(connection,
                      "SELECT x, y, count, position, angle, size, response, observations, distinctiveness, "
                      "last_survey, descriptor, checksum "
                      "FROM keypoint_tile ORDER BY x, y");
  const std::size_t row_bytes = static_cast<std::size_t>(length) * keypoints.descriptors.elemSize();
  while (row.Step()) {
    const KeypointTile tile{static_cast<int>(row.Integer(0)), static_cast<int>(row.Integer(1)), side_m};
    const KeypointBlobs blobs{static_cast<int>(row.Integer(2)),
                              row.Bytes(3),
                              row.Bytes(4),
                              row.Bytes(5),
                              row.Bytes(6),
                              row.Bytes(7),
                              row.Bytes(8),
                              row.Bytes(9),
                              row.Bytes(10)};
    if (blobs.Checksum() != row.Integer(11) || !UnpackKeypoints(blobs, tile, row_bytes, &keypoints)) {
      Damaged("keypoints of tile " + std::to_string(tile.x) + "," + std::to_string(tile.y));
    }
  }
  return keypoints;
}

MapDatabase::MapDatabase(const std::filesystem::path& file) : impl_(std::make_unique<Impl>(file)) {}

MapDatabase::~MapDatabase() = default;

MapInfo MapDatabase::ReadInfo() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->ReadInfo();
}

MosaicLayout MapDatabase::ReadMosaicLayout() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->ReadMosaicLayout();
}

FloorMap MapDatabase::ReadMap() const {
  const std::lock_guard lock(impl_->mutex);
  return {impl_->ReadInfo(), impl_->ReadMosaicLayout(), impl_->ReadKeypoints()};
}

std::vector<MapFrame> MapDatabase::ReadFrames() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->ReadFrames();
}

std::vector<MapLink> MapDatabase::ReadLinks() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->ReadLinks();
}

std::optional<std::vector<std::uint8_t>> MapDatabase::ReadMosaicTile(const TileId& tile) const {
  const std::lock_guard lock(impl_->mutex);
  SqliteStatement row(impl_->connection, "SELECT jpeg, checksum FROM mosaic_tile WHERE z = ? AND x = ? AND y = ?");
  row.Bind(tile.z).Bind(tile.x).Bind(tile.y);
  if (!row.Step()) {
    return std::nullopt;
  }
  Blob jpeg = row.Bytes(0);
  ContentHash hash;
  if (hash.Add(jpeg).Checksum() != row.Integer(1)) {
    impl_->Damaged("a mosaic tile");
  }
  return jpeg;
}

std::vector<TileId> MapDatabase::ListMosaicTiles(int zoom) const {
  const std::lock_guard lock(impl_->mutex);
  SqliteStatement row(impl_->connection, "SELECT z, x, y FROM mosaic_tile WHERE z = ? ORDER BY x, y");
  row.Bind(zoom);
  std::vector<TileId> tiles;
  while (row.Step()) {
    tiles.push_back(
        {static_cast<int>(row.Integer(0)), static_cast<int>(row.Integer(1)), static_cast<int>(row.Integer(2))});
  }
  return tiles;
}

void MapDatabase::VerifyContent() const {
  const MapInfo info = ReadMap().info;
  for (int zoom = 0; zoom <= ReadMosaicLayout().max_zoom; ++zoom) {
    for (const TileId& tile : ListMosaicTiles(zoom)) {
      ReadMosaicTile(tile);
    }
  }
  const std::lock_guard lock(impl_->mutex);
  if (ComputeContentVersion(impl_->connection) != info.content_version) {
    impl_->Damaged("its content does not have the recorded version");
  }
}

}  // namespace floorloc
