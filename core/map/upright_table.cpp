// SPDX-License-Identifier: Apache-2.0
#include "core/map/upright_table.h"

#include <cstring>
#include <string>

#include "core/map/checked_row.h"
#include "core/map/content_hash.h"
#include "core/map/keypoint_blobs.h"
#include "core/map/map_contract.h"
#include "core/vision/extractors/steered_brief.h"

namespace floorloc {

void WriteUpright(const SqliteConnection& connection, const MapKeypoints& keypoints, double tile_m) {
  if (keypoints.upright.empty()) {
    return;
  }
  SqliteStatement insert(connection, "INSERT INTO keypoint_upright VALUES (?,?,?,?)");
  for (const auto& [tile, indices] : KeypointsByTile(keypoints, tile_m)) {
    Blob descriptors;
    for (const int i : indices) {
      const std::uint8_t* row = keypoints.upright.ptr(i);
      descriptors.insert(descriptors.end(), row, row + keypoints.upright.cols);
    }
    ContentHash hash;
    const std::int64_t checksum = hash.Add(descriptors).Checksum();
    insert.Bind(tile.first).Bind(tile.second).Bind(descriptors).Bind(checksum).Run();
  }
}

cv::Mat ReadUpright(const SqliteConnection& connection, std::size_t keypoints) {
  cv::Mat upright(static_cast<int>(keypoints), kBriefBytes, CV_8UC1);
  SqliteStatement statement(connection,
                            "SELECT k.x, k.y, LENGTH(k.angle) / 4, u.descriptor, u.checksum FROM keypoint_tile k "
                            "LEFT JOIN keypoint_upright u ON u.x = k.x AND u.y = k.y ORDER BY k.x, k.y");
  std::size_t at = 0;
  while (statement.Step()) {
    const CheckedRow row(
        connection, statement,
        "upright tile " + std::to_string(statement.Integer(0)) + "," + std::to_string(statement.Integer(1)));
    const auto count = static_cast<std::size_t>(statement.Integer(2));
    const Blob descriptors = row.Bytes(3, "descriptor");
    ContentHash hash;
    if (descriptors.size() != count * kBriefBytes || hash.Add(descriptors).Checksum() != row.Long(4, "checksum")) {
      row.Refuse("it does not hold one descriptor per keypoint, or its checksum differs");
    }
    if (count > 0) {
      std::memcpy(upright.ptr(static_cast<int>(at)), descriptors.data(), descriptors.size());
    }
    at += count;
  }
  return upright;
}

}  // namespace floorloc
