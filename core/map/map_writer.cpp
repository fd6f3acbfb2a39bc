// SPDX-License-Identifier: Apache-2.0
#include "core/map/map_writer.h"

#include <array>

#include "core/map/camera_mask_table.h"
#include "core/map/content_hash.h"
#include "core/map/extractor_parameters.h"
#include "core/map/floor_lattice_table.h"
#include "core/map/floor_texture_table.h"
#include "core/map/keypoint_blobs.h"
#include "core/map/map_contract.h"
#include "core/map/map_layers.h"
#include "core/map/map_tables.h"
#include "core/map/part_file.h"
#include "core/map/upright_table.h"
#include "schema/embedded.h"

namespace floorloc {
namespace {

constexpr double kKeypointTileM = 1.0;

void BindPose(const Pose2& pose, SqliteStatement* statement) {
  statement->Bind(pose.x()).Bind(pose.y()).Bind(pose.yaw());
}

void WriteCamera(const SqliteConnection& connection, int survey, const FloorCamera& c) {
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> homography = c.floor.base_from_pixel;
  SqliteStatement insert(connection, "INSERT INTO camera VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
  insert.Bind(survey).Bind(c.camera.name).Bind(c.camera.width_px).Bind(c.camera.height_px);
  insert.Bind(c.camera.fx).Bind(c.camera.fy).Bind(c.camera.cx).Bind(c.camera.cy);
  insert.Bind(std::string(ToString(c.camera.distortion_model))).Bind(PackDoubles(c.camera.distortion));
  insert.Bind(PackDoubles(std::span(homography.data(), 9)));
  insert.Bind(c.floor.roi.x_min).Bind(c.floor.roi.x_max).Bind(c.floor.roi.y_min).Bind(c.floor.roi.y_max);
  insert.Bind(c.floor.resolution_m).Run();
}

void WriteCalibration(const SqliteConnection& connection, int survey, const FloorCamera& c, const FloorCamera& given) {
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> homography = given.floor.base_from_pixel;
  SqliteStatement insert(connection, "INSERT INTO calibration VALUES (?,?,?,?,?,?,?,?,?)");
  insert.Bind(survey).Bind(c.camera.sigma_px).Bind(c.floor.offset_sigma_m);
  insert.Bind(given.camera.fx).Bind(given.camera.fy).Bind(given.camera.cx).Bind(given.camera.cy);
  insert.Bind(PackDoubles(given.camera.distortion)).Bind(PackDoubles(std::span(homography.data(), 9))).Run();
}

}  // namespace

struct MapWriter::Impl {
  explicit Impl(const std::filesystem::path& target)
      : file(target), part(target.string() + ".part"), connection(part.path(), SqliteConnection::Mode::kCreate) {
    // The file is not used before the rename, which follows an fsync, so intermediate flushes are not needed.
    connection.Execute("PRAGMA page_size = 8192; PRAGMA locking_mode = EXCLUSIVE; PRAGMA synchronous = OFF;");
    connection.Execute(std::string(MapSql()));
  }

  std::filesystem::path file;
  PartFile part;  // outlives the connection
  SqliteConnection connection;
  DescriptorType descriptor_type = DescriptorType::kBinary;
  int descriptor_length = 0;

  std::string WriteInfo(const MapInfo& info, const MosaicLayout& mosaic) const;
};

std::string MapWriter::Impl::WriteInfo(const MapInfo& info, const MosaicLayout& mosaic) const {
  SqliteTransaction transaction(connection);
  SqliteStatement insert(connection, "INSERT INTO map VALUES (1,?,?,'',?,?,'map',?,?,?,?,?,?,?,?,?,?,?,?,?)");
  insert.Bind(info.builder_version).Bind(info.id).Bind(info.name).Bind(info.created).Bind(mosaic.resolution_m);
  insert.Bind(info.extent.x_min).Bind(info.extent.x_max).Bind(info.extent.y_min).Bind(info.extent.y_max);
  insert.Bind(info.area_m2).Bind(kKeypointTileM).Bind(std::string(ToString(descriptor_type))).Bind(descriptor_length);
  insert.Bind(mosaic.tile_px).Bind(mosaic.max_zoom).Bind(info.surveys_json).Bind(info.report_json).Run();
  for (const auto& [name, value] : ToParameters(info.extractor)) {
    SqliteStatement(connection, "INSERT INTO extractor_parameter VALUES (?,?)").Bind(name).Bind(value).Run();
  }
  for (std::size_t survey = 0; survey < info.cameras.size(); ++survey) {
    const FloorCamera& camera = info.cameras[survey];
    WriteCamera(connection, static_cast<int>(survey), camera);
    WriteCalibration(connection, static_cast<int>(survey), camera,
                     info.given_cameras.empty() ? camera : info.given_cameras[survey]);
  }
  for (const MapParent& parent : info.parents) {
    SqliteStatement(connection, "INSERT INTO parent VALUES (?,?,?)")
        .Bind(parent.relation)
        .Bind(parent.id)
        .Bind(parent.content_version)
        .Run();
  }
  WriteCameraMasks(connection, info);
  WriteFloorTextures(connection, info);
  WriteFloorLattices(connection, info.lattices);
  WriteLayers(connection);
  std::string version = ComputeContentVersion(connection);
  SqliteStatement(connection, "UPDATE map SET content_version = ?").Bind(version).Run();
  transaction.Commit();
  return version;
}

MapWriter::MapWriter(const std::filesystem::path& file) : impl_(std::make_unique<Impl>(file)) {}

MapWriter::~MapWriter() = default;

void MapWriter::WriteFrames(const std::vector<MapFrame>& frames) {
  SqliteTransaction transaction(impl_->connection);
  SqliteStatement insert(impl_->connection, "INSERT INTO frame VALUES (?,?,?,?,?,?,?,?,?,?,?)");
  for (std::size_t id = 0; id < frames.size(); ++id) {
    const MapFrame& frame = frames[id];
    insert.Bind(static_cast<std::int64_t>(id)).Bind(frame.survey).Bind(frame.stamp_ns).Bind(frame.filename);
    BindPose(frame.map_from_base, &insert);
    insert.Bind(frame.gain);
    if (frame.odom_from_base) {
      BindPose(*frame.odom_from_base, &insert);
    } else {
      insert.BindNull().BindNull().BindNull();
    }
    insert.Run();
  }
  transaction.Commit();
}

void MapWriter::WriteLinks(const std::vector<MapLink>& links) {
  SqliteTransaction transaction(impl_->connection);
  SqliteStatement insert(impl_->connection, "INSERT INTO link VALUES (?,?,?,?,?,?,?,?,?)");
  for (const MapLink& link : links) {
    const Eigen::Matrix3d& c = link.covariance;
    const std::array<double, 6> upper = {c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2)};
    insert.Bind(link.first).Bind(link.second);
    BindPose(link.first_from_second, &insert);
    insert.Bind(PackDoubles(upper)).Bind(link.inliers).Bind(link.rms_m).Bind(link.residual_sigma).Run();
  }
  transaction.Commit();
}

void MapWriter::WriteKeypoints(const MapKeypoints& keypoints, DescriptorType type) {
  impl_->descriptor_type = type;
  impl_->descriptor_length = keypoints.descriptors.cols;
  SqliteTransaction transaction(impl_->connection);
  SqliteStatement insert(impl_->connection, "INSERT INTO keypoint_tile VALUES (?,?,?,?,?,?,?,?,?,?,?,?)");
  for (const auto& [tile, indices] : KeypointsByTile(keypoints, kKeypointTileM)) {
    const KeypointBlobs b = PackKeypoints(keypoints, indices, {tile.first, tile.second, kKeypointTileM});
    insert.Bind(tile.first).Bind(tile.second).Bind(b.count).Bind(b.position).Bind(b.angle).Bind(b.size);
    insert.Bind(b.response).Bind(b.observations).Bind(b.distinctiveness).Bind(b.last_survey);
    insert.Bind(b.descriptor).Bind(b.Checksum()).Run();
  }
  transaction.Commit();
}

void MapWriter::WriteUprightDescriptors(const MapKeypoints& keypoints) {
  SqliteTransaction transaction(impl_->connection);
  WriteUpright(impl_->connection, keypoints, kKeypointTileM);
  transaction.Commit();
}

std::optional<std::vector<std::uint8_t>> MapWriter::ReadMosaicTile(const TileId& tile) const {
  return ReadTile(impl_->connection, tile);
}

void MapWriter::WriteMosaicTiles(const std::vector<MosaicTile>& tiles) {
  SqliteTransaction transaction(impl_->connection);
  SqliteStatement insert(impl_->connection, "INSERT INTO mosaic_tile VALUES (?,?,?,?,?)");
  for (const MosaicTile& tile : tiles) {
    ContentHash hash;
    insert.Bind(tile.id.z).Bind(tile.id.x).Bind(tile.id.y).Bind(tile.jpeg).Bind(hash.Add(tile.jpeg).Checksum()).Run();
  }
  transaction.Commit();
}

std::string MapWriter::Commit(const MapInfo& info, const MosaicLayout& mosaic) {
  std::string version = impl_->WriteInfo(info, mosaic);
  impl_->connection = SqliteConnection(":memory:", SqliteConnection::Mode::kCreate);  // closes the file
  impl_->part.MoveTo(impl_->file);
  return version;
}

}  // namespace floorloc
