// SPDX-License-Identifier: Apache-2.0
#include "server/api/camera_json.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "server/wire/strict_json.h"

namespace floorloc {
namespace {

constexpr std::int64_t kMaxSidePx = 1'000'000;

// A flat list, or a ROS matrix {rows, cols, data}.
std::vector<double> MatrixNumbers(JsonObject& object, const std::string& key) {
  const nlohmann::json& value = object.Value(key);
  if (!value.is_object()) {
    return ReadNumbers(value, object.PathOf(key));
  }
  JsonObject matrix = object.Object(key);
  std::vector<double> numbers = matrix.Numbers("data");
  const std::int64_t rows = matrix.Integer("rows", 1, 100);
  const std::int64_t cols = matrix.Integer("cols", 1, 100);
  if (rows * cols != static_cast<std::int64_t>(numbers.size())) {
    throw JsonError(object.PathOf(key) + ": rows x cols does not agree with the number of values in data.");
  }
  return numbers;
}

std::vector<double> NineNumbers(JsonObject& object, const std::string& key) {
  std::vector<double> numbers = MatrixNumbers(object, key);
  if (numbers.size() != 9) {
    throw JsonError(object.PathOf(key) + " must have 9 numbers, row by row.");
  }
  return numbers;
}

// 0, which is unknown, when the key is missing.
double OptionalNumber(JsonObject& object, const std::string& key) { return object.Has(key) ? object.Number(key) : 0.0; }

// Leaves out what is unknown.
void AddKnown(const char* key, double value, nlohmann::json* json) {
  if (value > 0.0) {
    (*json)[key] = value;
  }
}

DistortionModel ParseModel(const std::string& name) {
  for (const DistortionModel model :
       {DistortionModel::kPlumbBob, DistortionModel::kRationalPolynomial, DistortionModel::kEquidistant}) {
    if (name == ToString(model)) {
      return model;
    }
  }
  throw JsonError("camera.distortion_model must be plumb_bob, rational_polynomial or equidistant.");
}

// Names that are none of the known ones are errors of the request.
template <typename Parse>
auto ParseNamed(JsonObject& object, const std::string& key, Parse parse) {
  const std::string name = object.Text(key);
  try {
    return parse(name);
  } catch (const std::invalid_argument& error) {
    throw JsonError(std::string("camera.") + error.what() + ".");
  }
}

Readout ParseReadout(JsonObject& object) {
  Readout readout;
  if (object.Has("readout_s")) {
    readout.seconds = object.Number("readout_s");
  }
  if (object.Has("readout_direction")) {
    readout.direction = ParseNamed(object, "readout_direction", ParseReadoutDirection);
  }
  if (object.Has("stamp_at")) {
    readout.stamp_at = ParseNamed(object, "stamp_at", ParseStampAt);
  }
  return readout;
}

void AddReadout(const Readout& readout, nlohmann::json* json) {
  if (readout.seconds) {
    (*json)["readout_s"] = *readout.seconds;
  }
  if (readout.seconds || readout.direction != ReadoutDirection::kDown) {
    (*json)["readout_direction"] = ToString(readout.direction);
  }
  if (readout.stamp_at != StampAt::kMiddle) {
    (*json)["stamp_at"] = ToString(readout.stamp_at);
  }
}

nlohmann::json Matrix(int rows, int cols, const std::vector<double>& data) {
  return {{"rows", rows}, {"cols", cols}, {"data", data}};
}

}  // namespace

CameraModel ParseCamera(const nlohmann::json& json) {
  JsonObject object(json, "camera");
  CameraModel camera;
  camera.width_px = static_cast<int>(object.Integer("image_width", 1, kMaxSidePx));
  camera.height_px = static_cast<int>(object.Integer("image_height", 1, kMaxSidePx));
  if (object.Has("camera_name")) {
    camera.name = object.Text("camera_name");
  }
  const std::vector<double> k = NineNumbers(object, "camera_matrix");
  if (k[1] != 0.0 || k[3] != 0.0 || k[6] != 0.0 || k[7] != 0.0 || k[8] != 1.0) {
    throw JsonError("camera.camera_matrix must be [fx, 0, cx, 0, fy, cy, 0, 0, 1].");
  }
  camera.fx = k[0];
  camera.cx = k[2];
  camera.fy = k[4];
  camera.cy = k[5];
  camera.distortion_model = ParseModel(object.Text("distortion_model"));
  camera.distortion = MatrixNumbers(object, "distortion_coefficients");
  camera.sigma_px = OptionalNumber(object, "calibration_sigma");
  camera.readout = ParseReadout(object);
  return camera;
}

FloorPlane ParseFloor(const nlohmann::json& json) {
  JsonObject object(json, "floor");
  FloorPlane floor;
  const std::vector<double> h = NineNumbers(object, "homography");
  floor.base_from_pixel = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(h.data());
  JsonObject roi = object.Object("roi");
  floor.roi = {roi.Number("x_min"), roi.Number("x_max"), roi.Number("y_min"), roi.Number("y_max")};
  floor.resolution_m = object.Number("resolution");
  floor.offset_sigma_m = OptionalNumber(object, "offset_sigma");
  return floor;
}

nlohmann::json FormatCamera(const CameraModel& camera) {
  nlohmann::json json = {
      {"image_width", camera.width_px},
      {"image_height", camera.height_px},
      {"camera_name", camera.name},
      {"camera_matrix", Matrix(3, 3, {camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0})},
      {"distortion_model", ToString(camera.distortion_model)},
      {"distortion_coefficients", Matrix(1, static_cast<int>(camera.distortion.size()), camera.distortion)}};
  AddKnown("calibration_sigma", camera.sigma_px, &json);
  AddReadout(camera.readout, &json);
  return json;
}

nlohmann::json FormatFloor(const FloorPlane& floor) {
  nlohmann::json homography = nlohmann::json::array();
  for (int i = 0; i < 9; ++i) {
    homography.push_back(floor.base_from_pixel(i / 3, i % 3));
  }
  nlohmann::json json = {{"homography", std::move(homography)},
                         {"roi",
                          {{"x_min", floor.roi.x_min},
                           {"x_max", floor.roi.x_max},
                           {"y_min", floor.roi.y_min},
                           {"y_max", floor.roi.y_max}}},
                         {"resolution", floor.resolution_m}};
  AddKnown("offset_sigma", floor.offset_sigma_m, &json);
  return json;
}

nlohmann::json FormatCorrection(const std::optional<AppliedCorrection>& correction) {
  return correction ? nlohmann::json{{"survey", correction->survey}, {"moved_px", correction->moved_px}}
                    : nlohmann::json();
}

}  // namespace floorloc
