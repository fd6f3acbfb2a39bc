// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <random>

#include "mapbuilder/report/map_evidence.h"

namespace floorloc {

/// A map of 3.2 x 2.4 m as from a good survey: a frame of 0.4 x 0.4 m every 0.1 m, looking straight down, exact links
/// between neighbours, 3,000 distinctive keypoints per square metre, each with several observations.
/// keep: selects the frames by the centre of their image.
inline MapEvidence MakeMapEvidence(const std::function<bool(const Eigen::Vector2d&)>& keep =
                                       [](const Eigen::Vector2d&) { return true; }) {
  MapEvidence evidence;
  FloorCamera camera;
  camera.floor.roi = {-0.2, 0.2, -0.2, 0.2};
  camera.floor.resolution_m = 1e-3;
  evidence.map.info.cameras = {camera};
  evidence.map.info.extent = {0.0, 3.2, 0.0, 2.4};
  evidence.map.info.area_m2 = 3.2 * 2.4;
  evidence.map.info.resolution_m = 1e-3;
  evidence.map.info.name = "hall";
  evidence.map.info.surveys_json = "[]";
  evidence.map.info.report_json = "{}";
  std::vector<std::vector<int>> number(29, std::vector<int>(21, -1));
  for (std::size_t i = 0; i < number.size(); ++i) {
    for (std::size_t j = 0; j < number[i].size(); ++j) {
      const Pose2 pose(0.2 + 0.1 * static_cast<double>(i), 0.2 + 0.1 * static_cast<double>(j), 0.0);
      if (!keep(pose.translation())) {
        continue;
      }
      number[i][j] = static_cast<int>(evidence.frames.size());
      evidence.frames.push_back(
          {number[i][j] * 100'000'000LL, "images/" + std::to_string(number[i][j]) + ".jpg", pose, 0, 1.0, pose});
      for (const int other : {i > 0 ? number[i - 1][j] : -1, j > 0 ? number[i][j - 1] : -1}) {
        if (other >= 0) {
          const Pose2& first = evidence.frames[static_cast<std::size_t>(other)].map_from_base;
          evidence.links.push_back(
              {other, number[i][j], first.Between(pose), 1e-6 * Eigen::Matrix3d::Identity(), 200, 3e-4, 0.5});
        }
      }
    }
  }
  std::mt19937 random(7);
  std::uniform_real_distribution<float> x(0.0F, 3.2F), y(0.0F, 2.4F);
  for (int i = 0; i < 23'000; ++i) {
    evidence.map.keypoints.keypoints.push_back({x(random), y(random), 0.0F, 0.01F, 1.0F});
  }
  evidence.map.keypoints.observations.assign(23'000, 5);
  evidence.map.keypoints.distinctiveness.assign(23'000, 220);
  evidence.map.keypoints.last_survey.assign(23'000, 0);
  evidence.build.frames = evidence.build.frames_used = static_cast<int>(evidence.frames.size());
  for (const double along : {0.6, 1.2, 1.8, 2.4}) {
    HeldOutFrame frame{"images/held.jpg", Pose2(along, 1.2, 0.0), "localized", ""};
    frame.error_m = 3e-4;
    evidence.build.held_out.push_back(frame);
  }
  return evidence;
}

/// Removes the keypoints in a rectangle.
inline void ClearKeypoints(const RectM& rect, MapEvidence* evidence) {
  MapKeypoints& keypoints = evidence->map.keypoints;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    if (!rect.Contains({keypoints.keypoints[i].x_m, keypoints.keypoints[i].y_m})) {
      keypoints.keypoints[kept] = keypoints.keypoints[i];
      keypoints.observations[kept] = keypoints.observations[i];
      keypoints.distinctiveness[kept] = keypoints.distinctiveness[i];
      ++kept;
    }
  }
  keypoints.keypoints.resize(kept);
  keypoints.observations.resize(kept);
  keypoints.distinctiveness.resize(kept);
}

/// Calls change(i) for the keypoints in a rectangle.
inline void ForKeypointsIn(const RectM& rect, const MapEvidence& evidence,
                           const std::function<void(std::size_t)>& change) {
  for (std::size_t i = 0; i < evidence.map.keypoints.size(); ++i) {
    const Keypoint& keypoint = evidence.map.keypoints.keypoints[i];
    if (rect.Contains({keypoint.x_m, keypoint.y_m})) {
      change(i);
    }
  }
}

}  // namespace floorloc
