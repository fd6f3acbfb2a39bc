// SPDX-License-Identifier: Apache-2.0
#include "server/store/vehicle_table.h"

#include <Eigen/Cholesky>
#include <span>

#include "core/map/content_hash.h"
#include "core/map/map_contract.h"

namespace floorloc {
namespace {

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

// Columns 2 to 7. Empty for one that no server wrote: a wrong pose is worse than none.
std::optional<RememberedPose> ReadPose(const SqliteStatement& row) {
  const std::vector<double> numbers = UnpackDoubles(row.Bytes(7));
  if (row.Text(2).empty() || numbers.size() != 9) {
    return std::nullopt;
  }
  const Eigen::Vector3d coordinates(row.Real(4), row.Real(5), row.Real(6));
  RememberedPose pose{row.Text(2), row.Integer(3), Pose2(coordinates.x(), coordinates.y(), coordinates.z()),
                      Eigen::Map<const RowMajor>(numbers.data())};
  if (!(coordinates.cwiseAbs().maxCoeff() <= kMaxMapCoordinateM) || !pose.covariance.allFinite() ||
      pose.covariance.llt().info() != Eigen::Success) {
    return std::nullopt;
  }
  return pose;
}

// Far beyond what a vehicle learns.
constexpr std::int64_t kMaxLearntBytes = 4'000'000;

// Columns 11 to 14.
RememberedLearning ReadLearning(const SqliteStatement& row) {
  RememberedLearning learning{row.Integer(11), row.Integer(12), {}};
  const Blob values = row.Bytes(13);
  if (ContentHash().Add(std::span(values)).Checksum() == row.Integer(14)) {
    learning.values = UnpackDoubles(values);
  }
  return learning;
}

}  // namespace

std::vector<RememberedVehicle> ReadVehicles(const SqliteConnection& connection) {
  SqliteStatement row(connection,
                      "SELECT vehicle.id, registration, map_id, stamp_ns, x, y, yaw, covariance, epoch, last_heard_s, "
                      "lost_reason, camera, camera_in_map, CASE WHEN length(learnt_values) <= ? THEN learnt_values "
                      "END, checksum FROM vehicle LEFT JOIN pose ON vehicle.id = pose.id LEFT JOIN learnt ON "
                      "vehicle.id = learnt.id ORDER BY vehicle.id");
  row.Bind(kMaxLearntBytes);
  std::vector<RememberedVehicle> vehicles;
  while (row.Step()) {
    RememberedVehicle vehicle{row.Text(0), row.Text(1), std::nullopt};
    if (!row.IsNull(8)) {
      vehicle.track = {ReadPose(row), static_cast<std::uint64_t>(row.Integer(8)), row.Real(9), row.Text(10)};
    }
    if (!row.IsNull(11)) {
      vehicle.learning = ReadLearning(row);
    }
    vehicles.push_back(std::move(vehicle));
  }
  return vehicles;
}

void WriteRegistration(const SqliteConnection& connection, const std::string& id, const std::string& registration) {
  SqliteStatement(connection, "INSERT OR REPLACE INTO vehicle VALUES (?,?)").Bind(id).Bind(registration).Run();
}

void WriteTrack(const SqliteConnection& connection, const std::string& id, const RememberedTrack& track) {
  const RememberedPose pose = track.pose.value_or(RememberedPose());
  const RowMajor covariance = pose.covariance;
  SqliteStatement(connection, "INSERT OR REPLACE INTO pose SELECT id,?,?,?,?,?,?,?,?,? FROM vehicle WHERE id = ?")
      .Bind(pose.map_id)
      .Bind(pose.stamp_ns)
      .Bind(pose.map_from_base.x())
      .Bind(pose.map_from_base.y())
      .Bind(pose.map_from_base.yaw())
      .Bind(PackDoubles(std::span(covariance.data(), 9)))
      .Bind(static_cast<std::int64_t>(track.epoch))
      .Bind(track.last_heard_s)
      .Bind(track.lost_reason)
      .Bind(id)
      .Run();
}

void WriteLearning(const SqliteConnection& connection, const std::string& id, const RememberedLearning& learning) {
  const Blob values = PackDoubles(learning.values);
  SqliteStatement(connection, "INSERT OR REPLACE INTO learnt SELECT id,?,?,?,? FROM vehicle WHERE id = ?")
      .Bind(learning.camera)
      .Bind(learning.camera_in_map)
      .Bind(values)
      .Bind(ContentHash().Add(std::span(values)).Checksum())
      .Bind(id)
      .Run();
}

void DeleteVehicle(const SqliteConnection& connection, const std::string& id) {
  SqliteStatement(connection, "DELETE FROM learnt WHERE id = ?").Bind(id).Run();
  SqliteStatement(connection, "DELETE FROM pose WHERE id = ?").Bind(id).Run();
  SqliteStatement(connection, "DELETE FROM vehicle WHERE id = ?").Bind(id).Run();
}

}  // namespace floorloc
