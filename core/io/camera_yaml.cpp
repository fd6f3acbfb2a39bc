// SPDX-License-Identifier: Apache-2.0
#include "core/io/camera_yaml.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "core/io/camera_import.h"
#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "core/io/yaml_document.h"

namespace floorloc {
namespace {

// yaml-cpp throws its own exceptions from any accessor; all of them mean a malformed file.
template <typename Parse>
auto ParseYaml(const std::string& text, const std::filesystem::path& source, Parse parse) {
  const YamlDocument document(text, source);
  try {
    auto result = parse(document);
    result.Check();
    return result;
  } catch (const YAML::Exception& error) {
    document.Fail(error.mark, "has an unexpected structure (" + error.msg + "); correct the line");
  } catch (const std::invalid_argument& error) {
    throw InputError(source, std::string(error.what()) + "; correct it");
  }
}

DistortionModel ParseDistortionModel(const YamlDocument& document) {
  const YAML::Node value = document.Get(document.root(), "distortion_model");
  const std::string name = document.Text(value, "distortion_model");
  for (const DistortionModel model :
       {DistortionModel::kPlumbBob, DistortionModel::kRationalPolynomial, DistortionModel::kEquidistant}) {
    if (name == ToString(model)) {
      return model;
    }
  }
  document.Fail(value.Mark(), "distortion_model must be plumb_bob, rational_polynomial or equidistant; correct it");
}

void RefuseOtherFormats(const YamlDocument& document) {
  if (const std::string format = OtherCameraFormat(document); !format.empty()) {
    const std::filesystem::path folder = document.source().parent_path();
    throw InputError(document.source(),
                     "is " + format + ", not camera.yaml; convert it with 'floorloc-mapbuilder import-camera " +
                         document.source().string() + " --out " + (folder.empty() ? "." : folder.string()) + "'");
  }
}

// Texts that are none of the known ones fail at their line.
template <typename Parse>
auto ParseNamed(const YamlDocument& document, const std::string& key, Parse parse) {
  const YAML::Node value = document.Get(document.root(), key);
  try {
    return parse(document.Text(value, key));
  } catch (const std::invalid_argument& error) {
    document.Fail(value.Mark(), std::string(error.what()) + "; correct it");
  }
}

Readout ReadoutFromYaml(const YamlDocument& document) {
  Readout readout;
  if (document.Has("readout_s")) {
    readout.seconds = document.Number(document.Get(document.root(), "readout_s"), "readout_s");
  }
  if (document.Has("readout_direction")) {
    readout.direction = ParseNamed(document, "readout_direction", ParseReadoutDirection);
  }
  if (document.Has("stamp_at")) {
    readout.stamp_at = ParseNamed(document, "stamp_at", ParseStampAt);
  }
  return readout;
}

CameraModel CameraFromYaml(const YamlDocument& document) {
  RefuseOtherFormats(document);
  CameraModel camera;
  camera.width_px = document.Pixels("image_width");
  camera.height_px = document.Pixels("image_height");
  if (const YAML::Node name = document.root()["camera_name"]; name.IsDefined() && !name.IsNull()) {
    camera.name = document.Text(name, "camera_name");
  }
  const auto k = document.FixedNumbers<9>("camera_matrix");
  if (k[1] != 0.0 || k[3] != 0.0 || k[6] != 0.0 || k[7] != 0.0 || k[8] != 1.0) {
    document.Fail(document.root()["camera_matrix"].Mark(),
                  "camera_matrix must be [fx, 0, cx, 0, fy, cy, 0, 0, 1], row by row; correct it");
  }
  camera.fx = k[0];
  camera.cx = k[2];
  camera.fy = k[4];
  camera.cy = k[5];
  camera.distortion_model = ParseDistortionModel(document);
  camera.distortion = document.Numbers("distortion_coefficients");
  camera.sigma_px = document.OptionalNumber("calibration_sigma");
  camera.readout = ReadoutFromYaml(document);
  return camera;
}

FloorPlane FloorFromYaml(const YamlDocument& document) {
  FloorPlane floor;
  const auto h = document.FixedNumbers<9>("homography");
  floor.base_from_pixel = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(h.data());
  const YAML::Node roi = document.Get(document.root(), "roi");
  if (!roi.IsMap()) {
    document.Fail(roi.Mark(), "roi must have the keys x_min, x_max, y_min, y_max; correct it");
  }
  const auto bound = [&](const std::string& key) { return document.Number(document.Get(roi, key), "roi." + key); };
  floor.roi = {bound("x_min"), bound("x_max"), bound("y_min"), bound("y_max")};
  floor.resolution_m = document.Number(document.Get(document.root(), "resolution"), "resolution");
  floor.offset_sigma_m = document.OptionalNumber("offset_sigma");
  return floor;
}

// The shortest text that reads back as the same double. It has a dot: YAML 1.1 reads 7e-04 as a string.
std::string NumberText(double value) {
  std::array<char, 32> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  std::string text(buffer.data(), result.ptr);
  if (text.find('.') == std::string::npos) {
    text.insert(std::min(text.find('e'), text.size()), ".0");
  }
  return text;
}

// A line for a number that is left out when it is unknown.
std::string OptionalText(const std::string& key, double value) {
  return value > 0.0 ? key + ": " + NumberText(value) + "\n" : "";
}

std::string ReadoutText(const Readout& readout) {
  std::string text;
  if (readout.seconds) {
    text += "readout_s: " + NumberText(*readout.seconds) + "\n";
  }
  if (readout.seconds || readout.direction != ReadoutDirection::kDown) {
    text += std::string("readout_direction: ") + ToString(readout.direction) + "\n";
  }
  if (readout.stamp_at != StampAt::kMiddle) {
    text += std::string("stamp_at: ") + ToString(readout.stamp_at) + "\n";
  }
  return text;
}

std::string ListText(const std::vector<double>& numbers) {
  std::string text = "[";
  for (const double number : numbers) {
    text += (text.size() > 1 ? ", " : "") + NumberText(number);
  }
  return text + "]";
}

std::string MatrixText(const std::string& key, int rows, const std::vector<double>& data) {
  const std::size_t cols = data.size() / static_cast<std::size_t>(rows);
  return key + ":\n  rows: " + std::to_string(rows) + "\n  cols: " + std::to_string(cols) +
         "\n  data: " + ListText(data) + "\n";
}

}  // namespace

CameraModel ParseCameraYaml(const std::string& text, const std::filesystem::path& source) {
  return ParseYaml(text, source, CameraFromYaml);
}

FloorPlane ParseFloorYaml(const std::string& text, const std::filesystem::path& source) {
  return ParseYaml(text, source, FloorFromYaml);
}

FloorCamera ReadFloorCamera(const std::filesystem::path& folder) {
  const std::filesystem::path camera_file = folder / "camera.yaml";
  const std::filesystem::path floor_file = folder / "floor.yaml";
  FloorCamera camera{ParseCameraYaml(ReadTextFile(camera_file), camera_file),
                     ParseFloorYaml(ReadTextFile(floor_file), floor_file)};
  try {
    camera.Check();
  } catch (const std::invalid_argument& error) {
    throw InputError(floor_file, std::string(error.what()) + "; correct it");
  }
  return camera;
}

std::string FormatCameraYaml(const CameraModel& camera) {
  YAML::Emitter name;
  name << camera.name;
  return "image_width: " + std::to_string(camera.width_px) + "\nimage_height: " + std::to_string(camera.height_px) +
         "\ncamera_name: " + name.c_str() + "\n" +
         MatrixText("camera_matrix", 3, {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1}) +
         "distortion_model: " + ToString(camera.distortion_model) + "\n" +
         MatrixText("distortion_coefficients", 1, camera.distortion) +
         MatrixText("rectification_matrix", 3, {1, 0, 0, 0, 1, 0, 0, 0, 1}) +
         MatrixText("projection_matrix", 3, {camera.fx, 0, camera.cx, 0, 0, camera.fy, camera.cy, 0, 0, 0, 1, 0}) +
         OptionalText("calibration_sigma", camera.sigma_px) + ReadoutText(camera.readout);
}

std::string ReadFloorOrigin(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "floor.yaml";
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) {
    return {};
  }
  const YamlDocument document(ReadTextFile(file), file);
  return document.Has("origin") ? document.Text(document.Get(document.root(), "origin"), "origin") : std::string();
}

std::string FormatFloorYaml(const FloorPlane& floor, const std::string& origin) {
  YAML::Emitter origin_text;
  origin_text << origin;
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> h = floor.base_from_pixel;
  return "# homography: undistorted pixel (u, v, 1) -> base frame on the floor, metres (x forward, y left)\n"
         "homography: " +
         ListText({h.data(), h.data() + h.size()}) + "\nroi: {x_min: " + NumberText(floor.roi.x_min) +
         ", x_max: " + NumberText(floor.roi.x_max) + ", y_min: " + NumberText(floor.roi.y_min) +
         ", y_max: " + NumberText(floor.roi.y_max) + "}\nresolution: " + NumberText(floor.resolution_m) + "\n" +
         OptionalText("offset_sigma", floor.offset_sigma_m) +
         (origin.empty() ? "" : std::string("origin: ") + origin_text.c_str() + "\n");
}

}  // namespace floorloc
