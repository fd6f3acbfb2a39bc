// SPDX-License-Identifier: Apache-2.0
#include "server/api/inspection_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "server/api/pose_json.h"
#include "server/wire/base64.h"

namespace floorloc {
namespace {

// To 10 um: more digits would be most of the answer.
nlohmann::json FormatPoint(const Eigen::Vector2d& point) {
  return {1e-5 * std::round(1e5 * point.x()), 1e-5 * std::round(1e5 * point.y())};
}

nlohmann::json FormatCompetingPose(const CompetingPose& pose) {
  nlohmann::json json = FormatTransform(pose.map_from_base);
  json["inliers"] = pose.inliers;
  json["log10_nfa"] = pose.log10_nfa;
  nlohmann::json& matches = json["matches"] = nlohmann::json::array();
  for (const PointMatch& match : pose.matches) {
    matches.push_back(
        {{"base", FormatPoint(match.base_m)}, {"map", FormatPoint(match.map_m)}, {"inlier", match.inlier}});
  }
  return json;
}

}  // namespace

nlohmann::json FormatInspection(const Inspection& inspection) {
  const RectM& region = inspection.region;
  nlohmann::json keypoints = nlohmann::json::array();
  for (const Eigen::Vector2d& keypoint : inspection.keypoints) {
    keypoints.push_back(FormatPoint(keypoint));
  }
  nlohmann::json poses = nlohmann::json::array();
  for (const CompetingPose& pose : inspection.poses) {
    poses.push_back(FormatCompetingPose(pose));
  }
  return {
      {"image", EncodeBase64(inspection.image)},
      {"region", {{"x_min", region.x_min}, {"x_max", region.x_max}, {"y_min", region.y_min}, {"y_max", region.y_max}}},
      {"keypoints", std::move(keypoints)},
      {"poses", std::move(poses)}};
}

}  // namespace floorloc
