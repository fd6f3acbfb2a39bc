// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/build/map_scale.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "core/geometry/option_check.h"
#include "mapbuilder/placement/pose_graph.h"

namespace floorloc {
namespace {

struct SourceText {
  const char* name;
  const char* text;
};
constexpr std::array<SourceText, 6> kTexts = {{{"mounting", "the camera's height"},
                                               {"control_points", "control points"},
                                               {"distances", "measured distances"},
                                               {"poses", "the given poses"},
                                               {"odometry", "odometry"},
                                               {"base_map", "the map that was extended"}}};

// Least squares scale of points of known place: sigma^-2 = sum of squared distances from their mean over variances.
class PointScale {
 public:
  void Add(const Eigen::Vector2d& known_m, double misfit_m, double sigma_m) {
    points_.push_back({known_m, misfit_m, sigma_m});
  }

  // 0: fewer than two points.
  double Sigma() const {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    double weights = 0.0, misfits = 0.0;
    for (const Point& point : points_) {
      const double weight = 1.0 / (point.sigma_m * point.sigma_m);
      mean += weight * point.known_m;
      weights += weight;
      misfits += 0.5 * weight * point.misfit_m * point.misfit_m / static_cast<double>(points_.size());
    }
    double information = 0.0;
    for (const Point& point : points_) {
      information += (point.known_m - mean / weights).squaredNorm() / (point.sigma_m * point.sigma_m);
    }
    return points_.size() < 2 || information <= 0.0 ? 0.0 : std::sqrt(std::max(1.0, misfits) / information);
  }

 private:
  struct Point {
    Eigen::Vector2d known_m;
    double misfit_m;
    double sigma_m;
  };
  std::vector<Point> points_;
};

double SigmaOfMounting(const CalibratedFrames& map, const ScaleOptions& options) {
  double largest = 0.0;
  for (const LoadedSurvey& loaded : map.set.surveys) {
    largest = std::max(largest, options.height_sigma_m / std::abs(loaded.survey.camera.CameraCenter().z()));
  }
  return largest;
}

double SigmaOfControlPoints(const CalibratedFrames& map, const DistanceOptions& options) {
  std::map<std::pair<int, std::string>, std::size_t> by_name;
  for (std::size_t i = 0; i < map.set.frames.size(); ++i) {
    by_name[{map.set.frames[i].survey, map.set.frames[i].info.filename}] = i;
  }
  PointScale points;
  for (std::size_t s = 0; s < map.set.surveys.size(); ++s) {
    const Survey& survey = map.set.surveys[s].survey;
    for (const ControlPoint& point : survey.control_points) {
      const auto frame = by_name.find({static_cast<int>(s), point.filename});
      if (frame == by_name.end() || !map.placement.map_from_base[frame->second]) {
        continue;
      }
      const Eigen::Vector2d seen_m = *map.placement.map_from_base[frame->second] *
                                     FloorPointOf(map.set.frames[frame->second], map.set.surveys, point.raw_px);
      points.Add(point.point_in_map_m, (seen_m - point.point_in_map_m).norm(),
                 std::hypot(point.sigma_m.value_or(ControlPointFactor().sigma_m),
                            options.reading_px * survey.camera.floor.resolution_m));
    }
  }
  return points.Sigma();
}

double SigmaOfPoses(const CalibratedFrames& map) {
  PointScale points;
  for (std::size_t i = 0; i < map.set.frames.size(); ++i) {
    const auto& prior = map.set.frames[i].prior;
    if (prior && map.placement.map_from_base[i]) {
      points.Add(prior->map_from_base.translation(),
                 (map.placement.map_from_base[i]->translation() - prior->map_from_base.translation()).norm(),
                 std::sqrt(0.5 * (prior->covariance(0, 0) + prior->covariance(1, 1))));
    }
  }
  return points.Sigma();
}

double SigmaOfDistances(const std::vector<DistanceMisfit>& distances) {
  double information = 0.0, misfits = 0.0;
  for (const DistanceMisfit& distance : distances) {
    const double sigma = distance.sigma_m / distance.known_m;
    const double off = (distance.seen_m / distance.known_m - 1.0) / sigma;
    information += 1.0 / (sigma * sigma);
    misfits += off * off / static_cast<double>(distances.size());
  }
  return information > 0.0 ? std::sqrt(std::max(1.0, misfits) / information) : 0.0;
}

double Together(const std::vector<ScaleSource>& sources) {
  double information = 0.0;
  for (const ScaleSource& source : sources) {
    information += 1.0 / (source.sigma * source.sigma);
  }
  return information > 0.0 ? 1.0 / std::sqrt(information) : 0.0;
}

std::string Length(double m) {
  char text[32];
  std::snprintf(text, sizeof(text), m < 0.0995 ? "%.0f mm" : "%.2f m", m < 0.0995 ? std::max(1.0, 1e3 * m) : m);
  return text;
}

}  // namespace

void ScaleOptions::Check() const {
  RequireOption(height_sigma_m > 0.0, "height_sigma_m must be positive");
  RequireOption(wheel_sigma > 0.0, "wheel_sigma must be positive");
  RequireOption(named_m > 0.0, "named_m must be positive");
}

MapScale MeasureScale(const CalibratedFrames& map, const ScaleContext& context, const DistanceOptions& distances,
                      const ScaleOptions& options) {
  options.Check();
  MapScale scale;
  const auto add = [&](const char* name, double sigma) {
    if (sigma > 0.0) {
      scale.sources.push_back({name, sigma});
    }
  };
  if (context.base_sigma > 0.0) {
    add("base_map", context.base_sigma);  // whose frame holds the new frames
  } else {
    // Free heights make nothing of the camera's.
    add(context.by_odometry ? "odometry" : "mounting",
        context.by_odometry ? options.wheel_sigma : SigmaOfMounting(map, options));
    add("control_points", SigmaOfControlPoints(map, distances));
    add("distances", SigmaOfDistances(context.distances));
    add("poses", SigmaOfPoses(map));
  }
  std::stable_sort(scale.sources.begin(), scale.sources.end(),
                   [](const ScaleSource& a, const ScaleSource& b) { return a.sigma < b.sigma; });
  scale.sigma = Together(scale.sources);
  scale.span_m = std::hypot(context.extent.width_m(), context.extent.height_m());
  const double place_m = distances.reading_px * map.set.surveys.front().survey.camera.floor.resolution_m;
  scale.better_m = std::sqrt(distances.sigma_m * distances.sigma_m + 2.0 * place_m * place_m);
  return scale;
}

std::string ScaleText(const MapScale& scale, double named_m) {
  if (scale.sigma <= 0.0 || scale.sources.empty()) {
    return "";
  }
  std::string by = scale.sources.front().name;
  for (const SourceText& known : kTexts) {
    by = by == known.name ? known.text : by;
  }
  const double off_m = scale.sigma * scale.span_m;
  char text[128];
  std::snprintf(text, sizeof(text), "known to +-%.2g %% (by %s), %s over %.3g m", 100.0 * scale.sigma, by.c_str(),
                Length(off_m).c_str(), scale.span_m);
  if (off_m < named_m || off_m < 2.0 * scale.better_m) {
    return text;
  }
  return text +
         (": give two control points or one measured distance (--distance) to make it +-" + Length(scale.better_m));
}

}  // namespace floorloc
