// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <random>
#include <vector>

#include "core/geometry/floor_plane.h"
#include "core/geometry/pose2.h"
#include "mapbuilder/survey/build_frame.h"

namespace floorloc {

/// Region of interest of the frames, base frame.
inline const RectM kFloorInView{0.0, 0.4, -0.2, 0.2};

/// Keypoints of a floor of 1 m^2 from (0, 0), and frames that observe those within their region of interest.
class FloorPoints {
 public:
  FloorPoints(int count, bool binary, std::uint32_t seed) : random_(seed) {
    std::uniform_real_distribution<float> unit(0.0F, 1.0F);
    for (int i = 0; i < count; ++i) {
      const float x = unit(random_);
      const float y = unit(random_);
      points.push_back({x, y, 6.0F * unit(random_) - 3.0F, 0.02F, unit(random_)});
    }
    descriptors = cv::Mat(count, 32, binary ? CV_8U : CV_32F);
    cv::RNG(seed).fill(descriptors, cv::RNG::UNIFORM, 0, 256);
  }

  bool InView(std::size_t point, const Pose2& map_from_base) const {
    return kFloorInView.Contains(map_from_base.Inverse() * points[point].Position());
  }

  BuildFrame Observe(const Pose2& map_from_base, double noise_m) {
    std::normal_distribution<double> normal(0.0, noise_m);
    const Pose2 base_from_map = map_from_base.Inverse();
    BuildFrame frame;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!InView(i, map_from_base)) {
        continue;
      }
      const Eigen::Vector2d p = base_from_map * points[i].Position();
      Keypoint k = points[i];
      k.x_m = static_cast<float>(p.x() + normal(random_));
      k.y_m = static_cast<float>(p.y() + normal(random_));
      k.angle_rad = static_cast<float>(WrapAngle(k.angle_rad - map_from_base.yaw()));
      frame.features.keypoints.push_back(k);
      frame.features.descriptors.push_back(descriptors.row(static_cast<int>(i)));
    }
    return frame;
  }

  std::vector<Keypoint> points;
  cv::Mat descriptors;

 private:
  std::mt19937 random_;
};

}  // namespace floorloc
