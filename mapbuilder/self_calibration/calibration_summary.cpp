// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/self_calibration/calibration_summary.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>

namespace floorloc {
namespace {

struct UnknownText {
  const char* name;
  const char* unit;
  double factor;  // from radians and shares
};

constexpr double kDegrees = 180.0 / std::numbers::pi;

constexpr std::array<UnknownText, kCameraUnknowns> kTexts = {{{"roll", "degrees", kDegrees},
                                                              {"pitch", "degrees", kDegrees},
                                                              {"height", "%", 100.0},
                                                              {"focal", "%", 100.0},
                                                              {"k1", "", 1.0},
                                                              {"k2", "", 1.0},
                                                              {"p1", "", 1.0},
                                                              {"p2", "", 1.0}}};

// Names of the unknowns that were left as given, separated by commas.
std::string Unobserved(const CalibratedCamera& camera) {
  std::string names;
  for (const CameraUnknown unknown : camera.unobserved) {
    names += (names.empty() ? "" : ", ") + std::string(kTexts[static_cast<std::size_t>(unknown)].name);
  }
  return names;
}

bool MountingUnobserved(const CalibratedCamera& camera) {
  return std::any_of(camera.unobserved.begin(), camera.unobserved.end(), [](CameraUnknown unknown) {
    return unknown == CameraUnknown::kRoll || unknown == CameraUnknown::kPitch;
  });
}

}  // namespace

std::string ToText(const SelfCalibration& calibration) {
  if (!calibration.given_up.empty()) {
    return "  camera       calibration as given: " + calibration.given_up + "\n";
  }
  std::string text;
  char part[128];
  for (std::size_t survey = 0; survey < calibration.cameras.size(); ++survey) {
    const CalibratedCamera& camera = calibration.cameras[survey];
    std::snprintf(part, sizeof(part), "  camera       survey %zu:", survey + 1);
    text += part;
    for (int i = 0; i < kCameraUnknowns; ++i) {
      const UnknownText& unknown = kTexts[static_cast<std::size_t>(i)];
      if (camera.sigma[i] > 0.0) {
        std::snprintf(part, sizeof(part), " %s %+.4f +- %.4f %s;", unknown.name, unknown.factor * camera.change[i],
                      unknown.factor * camera.sigma[i], unknown.unit);
        text += part;
      }
    }
    if (!camera.unobserved.empty()) {
      text += " as given: " + Unobserved(camera);
      text += MountingUnobserved(camera) ? " (to tell the mounting, drive a strip turned by 90 degrees);" : ";";
    }
    std::snprintf(part, sizeof(part), " scatter of a point's observations %.3f mm, before %.3f mm\n",
                  1e3 * calibration.rms_after_m, 1e3 * calibration.rms_before_m);
    text += part;
  }
  return text;
}

std::string ToJson(const SelfCalibration& calibration) {
  if (calibration.cameras.empty()) {
    return "null";
  }
  nlohmann::ordered_json json{{"tracks", calibration.tracks},
                              {"rms_before_m", calibration.rms_before_m},
                              {"rms_after_m", calibration.rms_after_m},
                              {"given_up", calibration.given_up},
                              {"cameras", nlohmann::json::array()}};
  for (const CalibratedCamera& camera : calibration.cameras) {
    nlohmann::ordered_json found = nlohmann::json::object();
    for (int i = 0; i < kCameraUnknowns; ++i) {
      if (camera.sigma[i] > 0.0) {
        found[kTexts[static_cast<std::size_t>(i)].name] = {{"change", camera.change[i]}, {"sigma", camera.sigma[i]}};
      }
    }
    found["unobserved"] = nlohmann::json::array();
    for (const CameraUnknown unknown : camera.unobserved) {
      found["unobserved"].push_back(kTexts[static_cast<std::size_t>(unknown)].name);
    }
    json["cameras"].push_back(found);
  }
  return json.dump();
}

}  // namespace floorloc
