// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/heights/height_scale.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "mapbuilder/heights/height_graph.h"

namespace floorloc {
namespace {

// Shorter motions do not determine a scale.
constexpr double kMinMotionM = 0.02;

// Odometry drifts: only motions between frames that are this near in time count.
constexpr int kMaxFramesApart = 3;

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::optional<Pose2> MotionOf(const FrameSet& set, const Trajectory& poses, const ScaleLink& link) {
  const BuildFrame& first = set.frames[static_cast<std::size_t>(link.first)];
  const BuildFrame& second = set.frames[static_cast<std::size_t>(link.second)];
  if (!poses.empty()) {
    const auto from = InterpolatePose(poses, first.info.stamp_ns);
    const auto to = InterpolatePose(poses, second.info.stamp_ns);
    return from && to ? std::optional(from->Between(*to)) : std::nullopt;
  }
  const bool near = first.survey == second.survey && std::abs(link.second - link.first) <= kMaxFramesApart;
  if (!near || !first.odom_from_base || !second.odom_from_base || second.odometry_breaks) {
    return std::nullopt;
  }
  return first.odom_from_base->Between(*second.odom_from_base);
}

// Points below the camera, metres: heights scale the floor about them.
std::vector<Eigen::Vector2d> PointsBelow(const FrameSet& set) {
  std::vector<Eigen::Vector2d> below;
  for (const LoadedSurvey& loaded : set.surveys) {
    below.emplace_back(loaded.survey.camera.CameraCenter().head<2>());
  }
  return below;
}

// A length on the floor, metres.
struct Length {
  double known_m = 0.0;
  double seen_m = 0.0;
};

// Short lengths are read less precisely: the longer half tells.
std::optional<double> MedianRatio(const std::vector<Length>& lengths) {
  double longest_m = 0.0;
  for (const Length& length : lengths) {
    longest_m = std::max(longest_m, length.known_m);
  }
  std::vector<double> log_ratios;
  for (const Length& length : lengths) {
    if (length.known_m > 0.5 * longest_m && length.seen_m > kMinMotionM) {
      log_ratios.push_back(std::log(length.known_m / length.seen_m));
    }
  }
  return log_ratios.empty() ? std::nullopt : std::optional(std::exp(Median(std::move(log_ratios))));
}

}  // namespace

ScaledGroups ScaleByMotion(const FrameSet& set, const Trajectory& poses, const std::vector<ScaleLink>& links,
                           std::vector<double>* log_height) {
  const std::vector<int> group = LinkedGroups(static_cast<int>(set.frames.size()), links);
  const std::vector<Eigen::Vector2d> below = PointsBelow(set);
  std::map<int, std::vector<double>> log_ratios;
  for (const ScaleLink& link : links) {
    const auto first = static_cast<std::size_t>(link.first);
    const Eigen::Vector2d& from = below[static_cast<std::size_t>(set.frames[first].survey)];
    const Eigen::Vector2d& to =
        below[static_cast<std::size_t>(set.frames[static_cast<std::size_t>(link.second)].survey)];
    std::vector<double>& ratios = log_ratios[group[first]];
    const std::optional<Pose2> motion = MotionOf(set, poses, link);
    if (!motion) {
      continue;
    }
    const double known_m = (*motion * to - from).norm();
    const double seen_m = std::exp((*log_height)[first]) * (link.first_from_second * to - from).norm();
    if (known_m > kMinMotionM && seen_m > kMinMotionM) {
      ratios.push_back(std::log(known_m / seen_m));
    }
  }
  ScaledGroups groups;
  groups.all = static_cast<int>(log_ratios.size());
  for (auto& [number, ratios] : log_ratios) {
    if (ratios.empty()) {
      continue;
    }
    ++groups.moved;
    const double shift = Median(ratios);
    for (std::size_t i = 0; i < group.size(); ++i) {
      (*log_height)[i] += group[i] == number ? shift : 0.0;
    }
  }
  return groups;
}

std::optional<double> ScaleByKnownLengths(const FrameSet& set, const std::vector<std::optional<Pose2>>& map_from_base) {
  std::map<std::pair<std::size_t, std::string>, std::size_t> by_name;
  for (std::size_t i = 0; i < set.frames.size(); ++i) {
    by_name[{static_cast<std::size_t>(set.frames[i].survey), set.frames[i].info.filename}] = i;
  }
  std::vector<Length> lengths;
  for (std::size_t s = 0; s < set.surveys.size(); ++s) {
    const auto seen = [&](const std::string& file, const Eigen::Vector2d& raw_px) -> std::optional<Eigen::Vector2d> {
      const auto frame = by_name.find({s, file});
      if (frame == by_name.end() || !map_from_base[frame->second]) {
        return std::nullopt;
      }
      return *map_from_base[frame->second] * FloorPointOf(set.frames[frame->second], set.surveys, raw_px);
    };
    const Survey& survey = set.surveys[s].survey;
    for (const KnownDistance& distance : survey.known_distances) {
      const auto a = seen(distance.first_filename, distance.first_raw_px);
      const auto b = seen(distance.second_filename, distance.second_raw_px);
      if (a && b) {
        lengths.push_back({distance.distance_m, (*a - *b).norm()});
      }
    }
    for (std::size_t i = 0; i < survey.control_points.size(); ++i) {
      const ControlPoint& first = survey.control_points[i];
      const auto a = seen(first.filename, first.raw_px);
      for (std::size_t j = i + 1; a && j < survey.control_points.size(); ++j) {
        const ControlPoint& second = survey.control_points[j];
        if (const auto b = seen(second.filename, second.raw_px)) {
          lengths.push_back({(first.point_in_map_m - second.point_in_map_m).norm(), (*a - *b).norm()});
        }
      }
    }
  }
  return MedianRatio(lengths);
}

void MultiplyHeights(double factor, FrameSet* set) {
  const std::vector<Eigen::Vector2d> all_below = PointsBelow(*set);
  for (BuildFrame& frame : set->frames) {
    const Eigen::Vector2d& below = all_below[static_cast<std::size_t>(frame.survey)];
    frame.height_ratio *= factor;
    for (Keypoint& keypoint : frame.features.keypoints) {
      const Eigen::Vector2d p = below + factor * (keypoint.Position() - below);
      keypoint.x_m = static_cast<float>(p.x());
      keypoint.y_m = static_cast<float>(p.y());
      keypoint.size_m = static_cast<float>(factor * keypoint.size_m);
    }
  }
}

}  // namespace floorloc
