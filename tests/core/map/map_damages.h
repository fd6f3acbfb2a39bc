// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>
#include <string>
#include <vector>

namespace floorloc::testing_map {

/// Runs SQL on a map file with its constraints disabled, to damage it.
inline void RunSql(const std::filesystem::path& file, const std::string& sql) {
  sqlite3* handle = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &handle), SQLITE_OK);
  char* message = nullptr;
  const std::string all = "PRAGMA ignore_check_constraints = ON; " + sql;
  EXPECT_EQ(sqlite3_exec(handle, all.c_str(), nullptr, nullptr, &message), SQLITE_OK) << message << ": " << sql;
  sqlite3_free(message);
  sqlite3_close(handle);
}

/// Damages with which every reader must fail, over all tables of a map with at least two frames, a link, keypoints and
/// a mosaic.
// NOLINTNEXTLINE(readability-function-size): one table
inline const std::vector<std::string>& FatalDamages() {
  static const std::vector<std::string> damages = {
      "DELETE FROM map",
      "UPDATE map SET content_version = 'x'",
      "UPDATE map SET content_version = 'a' || char(13, 10) || 'Set-Cookie: b'",
      "UPDATE map SET name = x'00'",
      "UPDATE map SET frame = 'odom'",
      "UPDATE map SET resolution_m = 1e-300",
      "UPDATE map SET resolution_m = -1",
      "UPDATE map SET resolution_m = 9e999",
      "UPDATE map SET x_min = -1e300",
      "UPDATE map SET x_max = x_min - 1",
      "UPDATE map SET y_max = 'wide'",
      "UPDATE map SET area_m2 = 9e999",
      "UPDATE map SET area_m2 = -1",
      "UPDATE map SET keypoint_tile_m = 0",
      "UPDATE map SET descriptor_type = 'ternary'",
      "UPDATE map SET descriptor_length = 33",
      "UPDATE map SET descriptor_length = 1000000000",
      "UPDATE map SET mosaic_tile_px = 0",
      "UPDATE map SET mosaic_tile_px = 2147483648",
      "UPDATE map SET mosaic_max_zoom = 63",
      "UPDATE map SET mosaic_max_zoom = -1",
      "UPDATE map SET mosaic_max_zoom = mosaic_max_zoom - 1",
      "UPDATE map SET surveys_json = 'none'",
      "UPDATE map SET surveys_json = '{}'",
      "UPDATE map SET surveys_json = '[7]'",
      "UPDATE map SET report_json = '[]'",
      "UPDATE map SET report_json = '{\"a\":' || replace(hex(zeroblob(100000)), '00', '[') || '}'",
      ("UPDATE map SET report_json = '{\"a\":' || replace(hex(zeroblob(9000)), '00', '[') || "
       "replace(hex(zeroblob(9000)), '00', ']') || '}'"),
      "INSERT INTO parent VALUES ('dislikes', 'id', 'version')",
      "INSERT INTO parent VALUES ('extends', x'00', 'version')",
      "UPDATE extractor_parameter SET value = '1e9' WHERE name = 'levels'",
      "UPDATE extractor_parameter SET value = 'surff' WHERE name = 'type'",
      "UPDATE extractor_parameter SET value = 'nan' WHERE name = 'threshold'",
      "DELETE FROM extractor_parameter WHERE name = 'levels'",
      "INSERT INTO extractor_parameter VALUES ('upright', '1')",
      "DELETE FROM camera",
      "UPDATE camera SET survey = survey + 10",
      "UPDATE camera SET width_px = 0",
      "UPDATE camera SET height_px = 4294967776",
      "UPDATE camera SET fx = 'long'",
      "UPDATE camera SET cx = 9e999",
      "UPDATE camera SET distortion_model = 'thin_prism'",
      "UPDATE camera SET distortion = zeroblob(7)",
      "UPDATE camera SET distortion = CAST(x'000000000000f07f' || substr(distortion, 9) AS BLOB)",
      "UPDATE camera SET homography = zeroblob(72)",
      "UPDATE camera SET homography = zeroblob(71)",
      "UPDATE camera SET roi_x_max = 1e9",
      "UPDATE camera SET roi_x_max = roi_x_min",
      "UPDATE camera SET resolution_m = 1e-12",
      "DELETE FROM calibration",
      "DELETE FROM calibration WHERE survey = 0",
      "DELETE FROM calibration WHERE survey = (SELECT max(survey) FROM calibration)",
      "UPDATE calibration SET survey = survey + 10",
      "INSERT INTO calibration SELECT survey+9,0,0,1,1,0,0,given_distortion,given_homography FROM calibration",
      "UPDATE calibration SET sigma_px = -1",
      "UPDATE calibration SET sigma_px = 9e999",
      "UPDATE calibration SET sigma_px = 'small'",
      "UPDATE calibration SET offset_sigma_m = -1e-3",
      "UPDATE calibration SET offset_sigma_m = 9e999",
      "UPDATE calibration SET given_fx = -9e999",
      "UPDATE calibration SET given_fy = 0",
      "UPDATE calibration SET given_cx = 'left'",
      "UPDATE calibration SET given_cy = 9e999",
      "UPDATE calibration SET given_distortion = zeroblob(length(given_distortion) - 8)",
      "UPDATE calibration SET given_distortion = zeroblob(7)",
      "UPDATE calibration SET given_distortion = CAST(x'000000000000f07f' || substr(given_distortion, 9) AS BLOB)",
      "UPDATE calibration SET given_homography = zeroblob(72)",
      "UPDATE calibration SET given_homography = zeroblob(64)",
      "UPDATE calibration SET given_homography = CAST(x'000000000000f87f' || substr(given_homography, 9) AS BLOB)",
      "DROP TABLE calibration",
      "UPDATE frame SET survey = 1000000",
      "UPDATE frame SET survey = -1",
      "UPDATE frame SET survey = 4294967296",
      "UPDATE frame SET survey = 'first'",
      "UPDATE frame SET id = id + 1000",
      "UPDATE frame SET stamp_ns = 'now'",
      "UPDATE frame SET filename = x'ff'",
      "UPDATE frame SET x = 1e300",
      "UPDATE frame SET y = -9e999",
      "UPDATE frame SET x = x + 1e5 WHERE id = 0",
      "UPDATE frame SET yaw = 'north'",
      "UPDATE frame SET gain = 0",
      "UPDATE frame SET gain = 9e999",
      "UPDATE frame SET odom_x = 1, odom_y = NULL, odom_yaw = NULL",
      "UPDATE frame SET odom_x = 1e300, odom_y = 0, odom_yaw = 0",
      "DELETE FROM frame",
      "DELETE FROM frame WHERE id = 0",
      "UPDATE link SET first = first + 1000000",
      "UPDATE link SET first = -1 - first",
      "UPDATE link SET second = 4294967296 + second",
      "UPDATE OR REPLACE link SET first = second",
      "UPDATE link SET x = 1e300",
      "UPDATE link SET y = y - 1e5",
      "UPDATE link SET yaw = 9e999",
      "UPDATE link SET covariance = zeroblob(48)",
      "UPDATE link SET covariance = zeroblob(40)",
      "UPDATE link SET inliers = -1",
      "UPDATE link SET rms_m = 9e999",
      "UPDATE link SET residual_sigma = 'little'",
      "UPDATE keypoint_tile SET x = x + 4294967296",
      "UPDATE keypoint_tile SET y = y - 100000000",
      "UPDATE keypoint_tile SET count = count + 1",
      "UPDATE keypoint_tile SET count = -1",
      "UPDATE keypoint_tile SET count = 9000000000000",
      "UPDATE keypoint_tile SET position = zeroblob(length(position) - 4)",
      "UPDATE keypoint_tile SET position = 'here'",
      "UPDATE keypoint_tile SET angle = zeroblob(0)",
      "UPDATE keypoint_tile SET descriptor = zeroblob(7)",
      "UPDATE keypoint_tile SET last_survey = zeroblob(length(last_survey) + 2)",
      "UPDATE keypoint_tile SET checksum = checksum + 1",
      "UPDATE mosaic_tile SET z = z + 100",
      "UPDATE mosaic_tile SET z = -1 - z",
      "UPDATE mosaic_tile SET x = x + 1000000",
      "UPDATE mosaic_tile SET x = 2147483647 - x",
      "UPDATE mosaic_tile SET y = y - 4294967296",
      "DROP TABLE camera",
      "DROP TABLE frame",
      "DROP TABLE keypoint_tile",
      ("ALTER TABLE frame RENAME TO hidden; CREATE VIEW frame AS WITH RECURSIVE n(i) AS "
       "(SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT * FROM n, hidden"),
  };
  return damages;
}

/// Damages of content that only some readers use, or that give other valid values: reading may succeed or fail, but
/// must terminate.
inline const std::vector<std::string>& OtherDamages() {
  static const std::vector<std::string> damages = {
      "UPDATE map SET id = ''",
      "UPDATE map SET name = replace(hex(zeroblob(100000)), '00', 'x')",
      "UPDATE map SET name = cast(x'c328' AS TEXT)",
      "UPDATE map SET surveys_json = '[{\"folder\":7,\"frames\":\"many\"}]'",
      "UPDATE map SET surveys_json = '[]'",
      "UPDATE map SET report_json = '{}'",
      "UPDATE map SET report_json = '{\"frames\":1e300,\"parts\":7}'",
      "UPDATE map SET report_json = '{\"frames\":1e999}'",
      ("UPDATE map SET report_json = "
       "'{\"dropped\":[{\"filename\":\"a\",\"reason\":\"b\",\"near\":{\"x\":1e300,\"y\":0,\"yaw\":0}}]}'"),
      "UPDATE map SET report_json = '{\"held_out\":[{\"filename\":7}]}'",
      "UPDATE map SET report_json = '{\"flat_fields\":[{\"columns\":65536,\"rows\":65536,\"gain\":[]}]}'",
      "UPDATE map SET area_m2 = 1e9",
      "UPDATE map SET x_max = 9e6",
      "UPDATE map SET resolution_m = 2 * resolution_m",
      "UPDATE map SET keypoint_tile_m = 2",
      "UPDATE frame SET stamp_ns = 9223372036854775807",
      "UPDATE link SET residual_sigma = 1e300",
      "DELETE FROM link",
      "DELETE FROM mosaic_tile",
      "DELETE FROM mosaic_tile WHERE z = 0",
      "DELETE FROM keypoint_tile",
      "UPDATE mosaic_tile SET jpeg = zeroblob(10)",
      "UPDATE mosaic_tile SET checksum = checksum + 1",
  };
  return damages;
}

}  // namespace floorloc::testing_map
