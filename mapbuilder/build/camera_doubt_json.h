// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mapbuilder/self_calibration/camera_doubt.h"

namespace floorloc {

/// For nlohmann::basic_json, which finds them by their arguments.
template <typename Json>
void to_json(Json& json, const CameraDoubt& doubt) {
  json = Json{{"bend_rms_m", doubt.bend_rms_m},
              {"bend_largest_m", doubt.bend_largest_m},
              {"pose_rms_m", doubt.pose_rms_m},
              {"camera_px", doubt.camera_px}};
}

template <typename Json>
void from_json(const Json& json, CameraDoubt& doubt) {
  json.at("bend_rms_m").get_to(doubt.bend_rms_m);
  json.at("bend_largest_m").get_to(doubt.bend_largest_m);
  json.at("pose_rms_m").get_to(doubt.pose_rms_m);
  json.at("camera_px").get_to(doubt.camera_px);
}

}  // namespace floorloc
