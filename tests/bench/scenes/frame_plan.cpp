// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/scenes/frame_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "mapbuilder/simulation/simulated_noise.h"

namespace floorloc {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kEdgeShare = 0.08;
constexpr double kUnmappedShare = 0.06;
constexpr double kOtherFloorShare = 0.06;
constexpr double kEdgeReachM = 0.12;    // largest distance of the image's centre from the border, to either side
constexpr double kUnmappedGapM = 0.05;  // between the surveyed floor and an unmapped image
constexpr double kSpeedMPerS = 0.3;
constexpr double kPriorFill = 0.95;  // largest error of a prior, as a share of its radius
constexpr double kWrongPriorJitterM = 0.03;

struct Area {
  Eigen::Vector2d min_m;
  Eigen::Vector2d max_m;
};

// The base pose that puts the image's centre there.
Pose2 PoseWithViewAt(const Eigen::Vector2d& middle_m, double yaw_rad, const RectM& roi) {
  const Eigen::Vector2d position = middle_m - Pose2(0.0, 0.0, yaw_rad) * roi.Center();
  return {position.x(), position.y(), yaw_rad};
}

bool ViewIsInside(const Pose2& pose, const RectM& roi, const Area& area) {
  const std::array<Eigen::Vector2d, 4> corners = {
      Eigen::Vector2d(roi.x_min, roi.y_min), Eigen::Vector2d(roi.x_min, roi.y_max),
      Eigen::Vector2d(roi.x_max, roi.y_min), Eigen::Vector2d(roi.x_max, roi.y_max)};
  return std::all_of(corners.begin(), corners.end(), [&](const Eigen::Vector2d& corner) {
    const Eigen::Vector2d p = pose * corner;
    return (p.array() >= area.min_m.array()).all() && (p.array() <= area.max_m.array()).all();
  });
}

// Uniform over the poses whose whole image is inside the area.
Pose2 DrawPoseInside(const Area& area, const RectM& roi, cv::RNG& rng) {
  for (;;) {
    const double x = rng.uniform(area.min_m.x(), area.max_m.x());
    const double y = rng.uniform(area.min_m.y(), area.max_m.y());
    const Pose2 pose = PoseWithViewAt({x, y}, rng.uniform(-kPi, kPi), roi);
    if (ViewIsInside(pose, roi, area)) {
      return pose;
    }
  }
}

// A pose whose image crosses the right border of the surveyed floor.
Pose2 DrawPoseOnEdge(const FloorCase& floor, const RectM& roi, cv::RNG& rng) {
  const double margin = 0.5 * std::hypot(roi.width_m(), roi.height_m());
  const double x = floor.mapped_width_m + rng.uniform(-kEdgeReachM, kEdgeReachM);
  const double y = rng.uniform(margin, floor.texture.height_m - margin);
  return PoseWithViewAt({x, y}, rng.uniform(-kPi, kPi), roi);
}

FramePlace DrawPlace(cv::RNG& rng) {
  const double share = rng.uniform(0.0, 1.0);
  if (share < kEdgeShare) {
    return FramePlace::kEdge;
  }
  if (share < kEdgeShare + kUnmappedShare) {
    return FramePlace::kUnmapped;
  }
  return share < kEdgeShare + kUnmappedShare + kOtherFloorShare ? FramePlace::kOtherFloor : FramePlace::kMap;
}

// A prior that is off by one repetition to the right, left, top or bottom.
PlannedSearch DrawRepeatedPrior(const Pose2& truth, double repeat_m, cv::RNG& rng) {
  const double direction = 0.5 * kPi * rng.uniform(0, 4);
  const double jitter_x = rng.uniform(-kWrongPriorJitterM, kWrongPriorJitterM);
  const double jitter_y = rng.uniform(-kWrongPriorJitterM, kWrongPriorJitterM);
  PosePrior prior;
  prior.map_from_base = Pose2(truth.x() + repeat_m * std::cos(direction) + jitter_x,
                              truth.y() + repeat_m * std::sin(direction) + jitter_y, truth.yaw());
  return {SearchKind::kWrongPrior, prior};
}

template <typename Enum, std::size_t kCount>
Enum ParseByName(const std::string& name, const std::array<Enum, kCount>& values) {
  const auto found = std::find_if(values.begin(), values.end(), [&](Enum value) { return name == ToString(value); });
  if (found == values.end()) {
    throw std::invalid_argument("unknown name '" + name + "'");
  }
  return *found;
}

}  // namespace

const char* ToString(FramePlace place) {
  switch (place) {
    case FramePlace::kMap:
      return "map";
    case FramePlace::kEdge:
      return "edge";
    case FramePlace::kUnmapped:
      return "unmapped";
    case FramePlace::kOtherFloor:
      return "other_floor";
  }
  return "unknown";
}

FramePlace ParseFramePlace(const std::string& name) {
  return ParseByName(name,
                     std::array{FramePlace::kMap, FramePlace::kEdge, FramePlace::kUnmapped, FramePlace::kOtherFloor});
}

const char* ToString(SearchKind search) {
  switch (search) {
    case SearchKind::kGlobal:
      return "global";
    case SearchKind::kPrior:
      return "prior";
    case SearchKind::kWrongPrior:
      return "wrong_prior";
  }
  return "unknown";
}

SearchKind ParseSearchKind(const std::string& name) {
  return ParseByName(name, std::array{SearchKind::kGlobal, SearchKind::kPrior, SearchKind::kWrongPrior});
}

PosePrior DrawPrior(const Pose2& truth_from_base, cv::RNG& rng) {
  PosePrior prior;
  const double distance = kPriorFill * prior.radius_m * std::sqrt(rng.uniform(0.0, 1.0));
  const double direction = rng.uniform(-kPi, kPi);
  const double turn = kPriorFill * prior.yaw_radius_rad * rng.uniform(-1.0, 1.0);
  prior.map_from_base = Pose2(truth_from_base.x() + distance * std::cos(direction),
                              truth_from_base.y() + distance * std::sin(direction), truth_from_base.yaw() + turn);
  return prior;
}

FramePlan FramePlanner::Plan(int frame) const {
  FramePlan plan;
  plan.seed = DeriveSeed(seed, static_cast<std::uint64_t>(frame));
  cv::RNG rng(plan.seed);
  plan.place = DrawPlace(rng);
  if (only_on_map) {
    plan.place = FramePlace::kMap;
  } else if ((plan.place == FramePlace::kUnmapped || plan.place == FramePlace::kEdge) && floor.copies_itself) {
    plan.place = FramePlace::kOtherFloor;
  }
  plan.condition = static_cast<std::size_t>(rng.uniform(0, static_cast<int>(conditions)));
  plan.time_s = rng.uniform(0.0, 1000.0);
  plan.twist = {kSpeedMPerS * rng.uniform(-1.0, 1.0), 0.0, rng.uniform(-0.5, 0.5)};
  const Area mapped{{0.0, 0.0}, {floor.mapped_width_m, floor.texture.height_m}};
  const Area unmapped{{floor.mapped_width_m + kUnmappedGapM, 0.0}, {floor.texture.width_m, floor.texture.height_m}};
  if (plan.place == FramePlace::kOtherFloor) {
    plan.other_floor = static_cast<std::size_t>(rng.uniform(0, static_cast<int>(other_sizes_m.size())));
    plan.truth_from_base = DrawPoseInside({{0.0, 0.0}, other_sizes_m[plan.other_floor]}, roi, rng);
  } else if (plan.place == FramePlace::kEdge) {
    plan.truth_from_base = DrawPoseOnEdge(floor, roi, rng);
  } else {
    plan.truth_from_base = DrawPoseInside(plan.place == FramePlace::kMap ? mapped : unmapped, roi, rng);
  }
  plan.searches.push_back({SearchKind::kGlobal, std::nullopt});
  if (plan.place == FramePlace::kMap || plan.place == FramePlace::kEdge) {
    plan.searches.push_back({SearchKind::kPrior, DrawPrior(plan.truth_from_base, rng)});
    if (floor.repeat_m > 0.0) {
      plan.searches.push_back(DrawRepeatedPrior(plan.truth_from_base, floor.repeat_m, rng));
    }
  } else {
    PosePrior anywhere;
    anywhere.map_from_base = DrawPoseInside(mapped, roi, rng);
    plan.searches.push_back({SearchKind::kWrongPrior, anywhere});
  }
  return plan;
}

}  // namespace floorloc
