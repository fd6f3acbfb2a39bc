// SPDX-License-Identifier: Apache-2.0
#include "core/map/camera_mask_table.h"

#include <cstring>
#include <opencv2/core.hpp>

#include "core/map/camera_correction.h"
#include "core/map/checked_row.h"

namespace floorloc {
namespace {

constexpr std::int64_t kMaxMaskPixels = 100'000'000;

// Lengths of runs of floor and of what is none, by turns, row by row; the first is of floor and may be 0.
Blob PackRuns(const cv::Mat& mask) {
  std::vector<std::uint32_t> runs;
  bool floor = true;
  std::uint32_t length = 0;
  for (int row = 0; row < mask.rows; ++row) {
    for (int column = 0; column < mask.cols; ++column) {
      if ((mask.at<std::uint8_t>(row, column) != 0) != floor) {
        runs.push_back(length);
        length = 0;
        floor = !floor;
      }
      ++length;
    }
  }
  runs.push_back(length);
  Blob blob(runs.size() * sizeof(std::uint32_t));
  std::memcpy(blob.data(), runs.data(), blob.size());
  return blob;
}

cv::Mat UnpackRuns(const Blob& blob, const CameraModel& camera, const CheckedRow& row) {
  const std::int64_t pixels = std::int64_t{camera.width_px} * camera.height_px;
  if (pixels > kMaxMaskPixels) {
    row.Refuse("the camera has too many pixels for a mask");
  }
  std::vector<std::uint32_t> runs(blob.size() / sizeof(std::uint32_t));
  if (runs.empty() || blob.size() % sizeof(std::uint32_t) != 0) {
    row.Refuse("runs is no list of lengths");
  }
  std::memcpy(runs.data(), blob.data(), blob.size());
  std::int64_t total = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    total += runs[i];
    if ((runs[i] == 0 && i > 0) || total > pixels) {
      break;
    }
  }
  if (total != pixels) {
    row.Refuse("runs do not add up to the camera's pixels");
  }
  cv::Mat mask(1, static_cast<int>(pixels), CV_8UC1, cv::Scalar(255));
  int at = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const int end = at + static_cast<int>(runs[i]);
    if (i % 2 == 1) {
      mask.colRange(at, end).setTo(0);
    }
    at = end;
  }
  if (cv::countNonZero(mask) == 0) {
    row.Refuse("runs leave no floor");
  }
  return mask.reshape(1, camera.height_px);
}

}  // namespace

void WriteCameraMasks(const SqliteConnection& connection, const MapInfo& info) {
  SqliteStatement insert(connection, "INSERT INTO camera_mask VALUES (?,?,?,?)");
  for (std::size_t survey = 0; survey < info.masks.size(); ++survey) {
    const MapCameraMask& mask = info.masks[survey];
    if (!mask.raw.empty()) {
      insert.Bind(static_cast<std::int64_t>(survey)).Bind(mask.found ? 1 : 0);
      insert.Bind(PackRuns(mask.raw)).Bind(mask.picture).Run();
    }
  }
}

std::vector<MapCameraMask> ReadCameraMasks(const SqliteConnection& connection, const MapInfo& info) {
  std::vector<MapCameraMask> masks(info.cameras.size());
  SqliteStatement statement(connection, "SELECT survey, found, runs, picture FROM camera_mask ORDER BY survey");
  while (statement.Step()) {
    const CheckedRow row(connection, statement, "camera_mask");
    const int survey = row.Integer(0, "survey", 0, static_cast<std::int64_t>(masks.size()) - 1);
    MapCameraMask& mask = masks[static_cast<std::size_t>(survey)];
    mask.found = row.Integer(1, "found", 0, 1) == 1;
    mask.raw = UnpackRuns(row.Bytes(2, "runs"), info.cameras[static_cast<std::size_t>(survey)].camera, row);
    mask.picture = row.Bytes(3, "picture");
  }
  return masks;
}

cv::Mat MaskOfCamera(const MapInfo& info, const FloorCamera& camera) {
  const std::vector<FloorCamera>& given = info.given_cameras.empty() ? info.cameras : info.given_cameras;
  for (std::size_t survey = info.masks.size(); survey-- > 0;) {
    if (!info.masks[survey].raw.empty() && SameCalibration(given[survey], camera)) {
      return info.masks[survey].raw;
    }
  }
  return {};
}

}  // namespace floorloc
