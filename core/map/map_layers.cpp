// SPDX-License-Identifier: Apache-2.0
#include "core/map/map_layers.h"

#include <algorithm>
#include <array>
#include <limits>

#include "core/map/checked_row.h"
#include "core/map/content_hash.h"
#include "core/map/map_contract.h"

namespace floorloc {
namespace {

// A layer that this program reads and writes, with the queries of the rows that its hash covers. Blobs of tiles are
// covered by the checksums in their rows.
struct KnownLayer {
  const char* name;
  int version;
  bool required;
  std::array<const char*, 2> rows;  // nullptr: none
};

constexpr std::array<KnownLayer, 8> kKnownLayers = {{
    {kCalibrationLayer,
     1,
     false,
     {"SELECT survey, sigma_px, offset_sigma_m, given_fx, given_fy, given_cx, given_cy, given_distortion, "
      "given_homography FROM calibration ORDER BY survey",
      nullptr}},
    {kCameraMaskLayer, 1, false, {"SELECT survey, found, runs, picture FROM camera_mask ORDER BY survey", nullptr}},
    {kFloorLatticeLayer,
     1,
     false,
     {"SELECT region, x_min, x_max, y_min, y_max, floor_share, first_x, first_y, second_x, second_y, point_x, point_y, "
      "residual_m, share FROM floor_lattice ORDER BY region",
      nullptr}},
    {kFloorTextureLayer,
     1,
     false,
     {"SELECT survey, blocks, mean, covariance FROM floor_texture ORDER BY survey", nullptr}},
    {"frames",
     1,
     true,
     {"SELECT id, survey, stamp_ns, filename, x, y, yaw, gain, odom_x, odom_y, odom_yaw FROM frame ORDER BY id",
      "SELECT first, second, x, y, yaw, covariance, inliers, rms_m, residual_sigma FROM link ORDER BY first, second"}},
    {"keypoints",
     1,
     true,
     {"SELECT keypoint_tile_m, descriptor_type, descriptor_length FROM map",
      "SELECT x, y, count, checksum FROM keypoint_tile ORDER BY x, y"}},
    {"mosaic",
     1,
     true,
     {"SELECT resolution_m, mosaic_tile_px, mosaic_max_zoom FROM map",
      "SELECT z, x, y, checksum FROM mosaic_tile ORDER BY z, x, y"}},
    {kUprightLayer, 1, false, {"SELECT x, y, checksum FROM keypoint_upright ORDER BY x, y", nullptr}},
}};

// Optional layers are listed where their tables hold something; that of the calibrations always does.
bool IsEmpty(const SqliteConnection& connection, const KnownLayer& layer) {
  const std::string name = layer.name;
  const bool named_like_it = name == kCameraMaskLayer || name == kFloorLatticeLayer || name == kFloorTextureLayer;
  const char* table = name == kUprightLayer ? "keypoint_upright" : named_like_it ? name.c_str() : nullptr;
  return table != nullptr && !SqliteStatement(connection, std::string("SELECT 1 FROM ") + table).Step();
}

const KnownLayer* FindKnown(const std::string& name) {
  const auto* found =
      std::find_if(kKnownLayers.begin(), kKnownLayers.end(), [&](const KnownLayer& k) { return name == k.name; });
  return found == kKnownLayers.end() ? nullptr : found;
}

MapFileLayer ReadLayer(const SqliteConnection& connection, const SqliteStatement& statement) {
  const CheckedRow row(connection, statement, "layer '" + statement.Text(0) + "'");
  MapFileLayer layer;
  layer.name = row.Text(0, "name");
  layer.version = row.Integer(1, "version", 1, std::numeric_limits<int>::max());
  layer.required = row.Integer(2, "required", 0, 1) == 1;
  layer.content_hash = row.Text(3, "content_hash");
  if (!IsSha256(layer.content_hash)) {
    row.Refuse("content_hash is no SHA-256 in hex");
  }
  // A newer version of a layer that this program needs is unsupported, whatever the file calls it.
  const KnownLayer* known = FindKnown(layer.name);
  layer.known = known != nullptr && layer.version <= known->version;
  if (!layer.known && (layer.required || (known != nullptr && known->required))) {
    throw MapError(connection.file().string() + " has the layer '" + layer.name + "' in version " +
                       std::to_string(layer.version) +
                       ", which this program does not know and must not leave out; use a newer version of floorloc",
                   MapError::Kind::kUnsupported);
  }
  return layer;
}

}  // namespace

bool HasLayer(const std::vector<MapFileLayer>& layers, const std::string& name) {
  return std::any_of(layers.begin(), layers.end(), [&](const MapFileLayer& l) { return l.known && l.name == name; });
}

std::vector<MapFileLayer> ReadLayers(const SqliteConnection& connection) {
  std::vector<MapFileLayer> layers;
  if (ReadFormatVersion(connection) < kFirstVersionWithLayers) {
    for (const KnownLayer& known : kKnownLayers) {
      if (known.required) {
        layers.push_back({known.name, 1, true, "", true});
      }
    }
    return layers;
  }
  SqliteStatement statement(connection, "SELECT name, version, required, content_hash FROM layer ORDER BY name");
  while (statement.Step()) {
    layers.push_back(ReadLayer(connection, statement));
  }
  for (const KnownLayer& known : kKnownLayers) {
    if (known.required &&
        std::none_of(layers.begin(), layers.end(), [&](const MapFileLayer& l) { return l.name == known.name; })) {
      ThrowDamaged(connection, "it has no layer '" + std::string(known.name) + "'");
    }
  }
  return layers;
}

void WriteLayers(const SqliteConnection& connection) {
  SqliteStatement insert(connection, "INSERT INTO layer VALUES (?,?,?,?)");
  for (const KnownLayer& known : kKnownLayers) {
    if (IsEmpty(connection, known)) {
      continue;
    }
    insert.Bind(std::string(known.name)).Bind(known.version).Bind(known.required ? 1 : 0);
    insert.Bind(ComputeLayerHash(connection, known.name)).Run();
  }
}

std::string ComputeLayerHash(const SqliteConnection& connection, const std::string& name) {
  const KnownLayer* known = FindKnown(name);
  ContentHash hash;
  for (const char* rows : known->rows) {
    if (rows != nullptr) {
      AddRows(connection, rows, &hash);
    }
  }
  return hash.Hex();
}

}  // namespace floorloc
