// SPDX-License-Identifier: Apache-2.0
#include "core/map/map_contract.h"

#include <algorithm>
#include <cstring>

#include "core/map/content_hash.h"

namespace floorloc {
namespace {

// The type, then the value, so that different rows never yield the same bytes.
void AddValue(const SqliteStatement& row, int column, ContentHash* hash) {
  const int type = row.Type(column);
  hash->Add(std::int64_t{type});
  switch (type) {
    case SQLITE_INTEGER:
      hash->Add(row.Integer(column));
      return;
    case SQLITE_FLOAT:
      hash->Add(row.Real(column));
      return;
    case SQLITE_TEXT:
      hash->Add(row.Text(column));
      return;
    case SQLITE_BLOB: {
      const Blob bytes = row.Bytes(column);
      hash->Add(static_cast<std::int64_t>(bytes.size())).Add(bytes);
      return;
    }
    default:
      return;
  }
}

// Content version as in format version 2, which covers neither surveys nor report.
std::string ContentVersionOfFormat2(const SqliteConnection& connection) {
  ContentHash hash;
  SqliteStatement map(connection,
                      "SELECT resolution_m, x_min, x_max, y_min, y_max, area_m2, keypoint_tile_m, descriptor_type, "
                      "descriptor_length, mosaic_tile_px, mosaic_max_zoom FROM map");
  while (map.Step()) {
    for (int column = 0; column < 7; ++column) {
      hash.Add(map.Real(column));
    }
    hash.Add(map.Text(7)).Add(map.Integer(8)).Add(map.Integer(9)).Add(map.Integer(10));
  }
  SqliteStatement camera(connection,
                         "SELECT fx, fy, cx, cy, roi_x_min, roi_x_max, roi_y_min, roi_y_max, resolution_m, width_px, "
                         "height_px, distortion_model, distortion, homography FROM camera ORDER BY survey");
  while (camera.Step()) {
    for (int column = 0; column < 9; ++column) {
      hash.Add(camera.Real(column));
    }
    hash.Add(camera.Integer(9))
        .Add(camera.Integer(10))
        .Add(camera.Text(11))
        .Add(camera.Bytes(12))
        .Add(camera.Bytes(13));
  }
  SqliteStatement parameter(connection, "SELECT name, value FROM extractor_parameter ORDER BY name");
  while (parameter.Step()) {
    hash.Add(parameter.Text(0)).Add(parameter.Text(1));
  }
  SqliteStatement frame(connection,
                        "SELECT x, y, yaw, gain, odom_x, odom_y, odom_yaw, survey, stamp_ns, filename FROM frame "
                        "ORDER BY id");
  while (frame.Step()) {
    for (int column = 0; column < 7; ++column) {
      hash.Add(frame.Real(column));
    }
    hash.Add(frame.Integer(7)).Add(frame.Integer(8)).Add(frame.Text(9));
  }
  SqliteStatement link(connection,
                       "SELECT x, y, yaw, rms_m, residual_sigma, first, second, inliers, covariance FROM link "
                       "ORDER BY first, second");
  while (link.Step()) {
    for (int column = 0; column < 5; ++column) {
      hash.Add(link.Real(column));
    }
    hash.Add(link.Integer(5)).Add(link.Integer(6)).Add(link.Integer(7)).Add(link.Bytes(8));
  }
  SqliteStatement keypoints(connection, "SELECT x, y, count, checksum FROM keypoint_tile ORDER BY x, y");
  while (keypoints.Step()) {
    hash.Add(keypoints.Integer(0)).Add(keypoints.Integer(1)).Add(keypoints.Integer(2)).Add(keypoints.Integer(3));
  }
  SqliteStatement mosaic(connection, "SELECT z, x, y, checksum FROM mosaic_tile ORDER BY z, x, y");
  while (mosaic.Step()) {
    hash.Add(mosaic.Integer(0)).Add(mosaic.Integer(1)).Add(mosaic.Integer(2)).Add(mosaic.Integer(3));
  }
  return hash.Hex();
}

}  // namespace

Blob PackDoubles(std::span<const double> values) {
  Blob blob(values.size_bytes());
  if (!values.empty()) {
    std::memcpy(blob.data(), values.data(), blob.size());
  }
  return blob;
}

std::vector<double> UnpackDoubles(const Blob& blob) {
  std::vector<double> values(blob.size() % sizeof(double) == 0 ? blob.size() / sizeof(double) : 0);
  if (!values.empty()) {
    std::memcpy(values.data(), blob.data(), blob.size());
  }
  return values;
}

int ReadFormatVersion(const SqliteConnection& connection) {
  SqliteStatement statement(connection, "PRAGMA user_version");
  return statement.Step() ? static_cast<int>(statement.Integer(0)) : 0;
}

bool IsSha256(const std::string& text) {
  return text.size() == 64 &&
         std::all_of(text.begin(), text.end(), [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

void AddRows(const SqliteConnection& connection, const std::string& query, ContentHash* hash) {
  SqliteStatement row(connection, query);
  std::int64_t rows = 0;
  for (; row.Step(); ++rows) {
    for (int column = 0; column < row.columns(); ++column) {
      AddValue(row, column, hash);
    }
  }
  hash->Add(std::int64_t{row.columns()}).Add(rows);
}

std::string ComputeContentVersion(const SqliteConnection& connection) {
  if (ReadFormatVersion(connection) < kFirstVersionWithLayers) {
    return ContentVersionOfFormat2(connection);
  }
  ContentHash hash;
  AddRows(connection, "SELECT frame, x_min, x_max, y_min, y_max, area_m2, surveys_json, report_json FROM map", &hash);
  AddRows(connection, "SELECT relation, content_version FROM parent ORDER BY rowid", &hash);
  AddRows(connection, "SELECT name, value FROM extractor_parameter ORDER BY name", &hash);
  AddRows(connection,
          "SELECT survey, name, width_px, height_px, fx, fy, cx, cy, distortion_model, distortion, homography, "
          "roi_x_min, roi_x_max, roi_y_min, roi_y_max, resolution_m FROM camera ORDER BY survey",
          &hash);
  AddRows(connection, "SELECT name, version, required, content_hash FROM layer ORDER BY name", &hash);
  return hash.Hex();
}

}  // namespace floorloc
