// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/fleet/registration.h"

#include <nlohmann/json.hpp>
#include <vector>

#include "core/io/camera_yaml.h"

namespace floorloc {

nlohmann::json FormatRegistration(const std::string& map, const FloorCamera& camera) {
  const CameraModel& c = camera.camera;
  const FloorPlane& f = camera.floor;
  std::vector<double> homography;
  for (int i = 0; i < 9; ++i) {
    homography.push_back(f.base_from_pixel(i / 3, i % 3));
  }
  return {{"map", map},
          {"camera",
           {{"image_width", c.width_px},
            {"image_height", c.height_px},
            {"camera_name", c.name},
            {"camera_matrix", {c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0}},
            {"distortion_model", ToString(c.distortion_model)},
            {"distortion_coefficients", c.distortion}}},
          {"floor",
           {{"homography", homography},
            {"roi", {{"x_min", f.roi.x_min}, {"x_max", f.roi.x_max}, {"y_min", f.roi.y_min}, {"y_max", f.roi.y_max}}},
            {"resolution", f.resolution_m}}}};
}

// JSON is YAML.
FloorCamera ParseMapCamera(const nlohmann::json& map) {
  const std::string source = "map " + map.value("name", "") + ": its camera";
  FloorCamera camera;
  camera.camera = ParseCameraYaml(map.at("camera").dump(), source);
  camera.floor = ParseFloorYaml(map.at("floor").dump(), source);
  return camera;
}

}  // namespace floorloc
