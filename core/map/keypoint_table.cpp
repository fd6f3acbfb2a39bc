// SPDX-License-Identifier: Apache-2.0
#include "core/map/keypoint_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/map/checked_row.h"
#include "core/map/keypoint_blobs.h"
#include "core/map/map_contract.h"
#include "core/vision/extractors/extractor_layout.h"

namespace floorloc {
namespace {

struct KeypointColumns {
  DescriptorLayout descriptors;
  double tile_m = 1.0;

  bool binary() const { return descriptors.type == DescriptorType::kBinary; }
  std::size_t DescriptorBytes() const {
    return static_cast<std::size_t>(descriptors.length) * (binary() ? 1 : sizeof(float));
  }
};

KeypointColumns ReadColumns(const SqliteConnection& connection) {
  constexpr int kMaxDescriptorLength = 4096;
  SqliteStatement statement(connection, "SELECT descriptor_type, descriptor_length, keypoint_tile_m FROM map");
  if (!statement.Step()) {
    ThrowDamaged(connection, "no map row");
  }
  const CheckedRow row(connection, statement, "map");
  const std::string type = row.Text(0, "descriptor_type");
  if (type != ToString(DescriptorType::kBinary) && type != ToString(DescriptorType::kFloat)) {
    row.Refuse("unknown descriptor_type");
  }
  return {{type == ToString(DescriptorType::kBinary) ? DescriptorType::kBinary : DescriptorType::kFloat,
           row.Integer(1, "descriptor_length", 0, kMaxDescriptorLength)},
          row.Real(2, "keypoint_tile_m", 1e-3, 1e4)};
}

// The stored layout of a map without keypoints is not checked.
void CheckDescriptors(const SqliteConnection& connection, ExtractorType type, std::size_t keypoints,
                      DescriptorLayout* layout) {
  const DescriptorLayout expected = LayoutOf(type);
  if (keypoints > 0 && *layout != expected) {
    ThrowDamaged(connection, "map: its descriptors are " + ToString(*layout) + " each, those of its extractor '" +
                                 ToString(type) + "' are " + ToString(expected));
  }
  *layout = expected;
}

// From the actual lengths of the blobs, so never more than the file holds.
std::size_t CountKeypoints(const SqliteConnection& connection) {
  SqliteStatement sum(connection, "SELECT COALESCE(SUM(LENGTH(angle) / 4), 0) FROM keypoint_tile");
  sum.Step();
  const std::int64_t total = sum.Integer(0);
  if (total < 0 || total > std::numeric_limits<int>::max()) {
    ThrowDamaged(connection, "keypoint_tile: more keypoints than can be numbered");
  }
  return static_cast<std::size_t>(total);
}

// Checks the keypoints from `first` on, which are those of this row.
void CheckTile(const CheckedRow& row, const MapKeypoints& keypoints, std::size_t first, std::size_t surveys) {
  constexpr float kMaxAngleRad = 100.0F;
  constexpr float kMaxSizeM = 1e4F;
  for (std::size_t i = first; i < keypoints.size(); ++i) {
    const Keypoint& k = keypoints.keypoints[i];
    if (!(std::abs(k.angle_rad) <= kMaxAngleRad) || !(k.size_m >= 0.0F && k.size_m <= kMaxSizeM) ||
        !std::isfinite(k.response)) {
      row.Refuse("keypoint " + std::to_string(i - first) + " has an angle, size or response that none can have");
    }
    if (keypoints.last_survey[i] >= surveys) {
      row.Refuse("keypoint " + std::to_string(i - first) + " was last seen by survey " +
                 std::to_string(keypoints.last_survey[i]) + " of " + std::to_string(surveys));
    }
  }
}

}  // namespace

MapKeypoints ReadKeypointTable(const SqliteConnection& connection, const MapInfo& info) {
  KeypointColumns columns = ReadColumns(connection);
  const std::size_t total = CountKeypoints(connection);
  CheckDescriptors(connection, info.extractor.type, total, &columns.descriptors);
  MapKeypoints keypoints;
  keypoints.origin_m = KeypointOrigin(info.extent);
  keypoints.descriptors = cv::Mat(0, columns.descriptors.length, columns.binary() ? CV_8U : CV_32F);
  keypoints.keypoints.reserve(total);
  keypoints.observations.reserve(total);
  keypoints.distinctiveness.reserve(total);
  keypoints.last_survey.reserve(total);
  keypoints.descriptors.reserve(total);
  SqliteStatement statement(connection,
                            "SELECT x, y, count, position, angle, size, response, observations, distinctiveness, "
                            "last_survey, descriptor, checksum FROM keypoint_tile ORDER BY x, y");
  const auto farthest = static_cast<std::int64_t>(kMaxMapCoordinateM / columns.tile_m) + 1;
  while (statement.Step()) {
    const CheckedRow row(
        connection, statement,
        "keypoint tile " + std::to_string(statement.Integer(0)) + "," + std::to_string(statement.Integer(1)));
    const KeypointTile tile{row.Integer(0, "x", -farthest, farthest), row.Integer(1, "y", -farthest, farthest),
                            columns.tile_m};
    const KeypointBlobs blobs{row.Integer(2, "count", 0, std::numeric_limits<int>::max()),
                              row.Bytes(3, "position"),
                              row.Bytes(4, "angle"),
                              row.Bytes(5, "size"),
                              row.Bytes(6, "response"),
                              row.Bytes(7, "observations"),
                              row.Bytes(8, "distinctiveness"),
                              row.Bytes(9, "last_survey"),
                              row.Bytes(10, "descriptor")};
    if (blobs.Checksum() != row.Long(11, "checksum")) {
      row.Refuse("its checksum differs");
    }
    const std::size_t first = keypoints.size();
    if (!UnpackKeypoints(blobs, tile, columns.DescriptorBytes(), &keypoints)) {
      row.Refuse("a column does not hold as many values as count says, or a value that none can have");
    }
    CheckTile(row, keypoints, first, info.cameras.size());
  }
  return keypoints;
}

}  // namespace floorloc
