// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/absolute_constraints.h"

#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "core/io/input_error.h"
#include "core/registration/least_squares.h"
#include "mapbuilder/placement/spanning_forest.h"

namespace floorloc {
namespace {

// A point of a frame: where the graph has it (source) and where the map has it (target).
struct KnownPoint {
  int frame = 0;
  OrientedMatch pair;
};

std::vector<KnownPoint> AddPriors(const std::vector<BuildFrame>& frames, PoseGraph* graph) {
  std::vector<KnownPoint> known;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (const auto& prior = frames[i].prior) {
      const int frame = static_cast<int>(i);
      graph->priors.push_back({frame, prior->map_from_base, prior->covariance});
      known.push_back({frame, {graph->map_from_base[i].translation(), prior->map_from_base.translation(), 0.0, 0.0}});
    }
  }
  return known;
}

std::vector<KnownPoint> AddControlPoints(const std::vector<BuildFrame>& frames,
                                         const std::vector<LoadedSurvey>& surveys, PoseGraph* graph) {
  std::map<std::pair<int, std::string>, int> by_name;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    by_name[{frames[i].survey, frames[i].info.filename}] = static_cast<int>(i);
  }
  std::vector<KnownPoint> known;
  for (std::size_t s = 0; s < surveys.size(); ++s) {
    for (const ControlPoint& point : surveys[s].survey.control_points) {
      ControlPointFactor factor;
      factor.frame = by_name.at({static_cast<int>(s), point.filename});
      factor.point_in_base_m = surveys[s].survey.camera.FloorFromRawPixel(point.raw_px);
      factor.point_in_map_m = point.point_in_map_m;
      graph->control_points.push_back(factor);
      const Pose2& map_from_base = graph->map_from_base[static_cast<std::size_t>(factor.frame)];
      known.push_back({factor.frame, {map_from_base * factor.point_in_base_m, factor.point_in_map_m, 0.0, 0.0}});
    }
  }
  return known;
}

// Moves each part of the graph so that its own pairs agree. A part without any goes with the first part that has some.
void AlignParts(const std::vector<KnownPoint>& known, PoseGraph* graph) {
  const auto count = static_cast<int>(graph->map_from_base.size());
  const std::vector<int> part = FindComponents(count, graph->LinksAndOdometry());
  std::map<int, std::vector<OrientedMatch>> pairs;
  for (const KnownPoint& point : known) {
    pairs[part[static_cast<std::size_t>(point.frame)]].push_back(point.pair);
  }
  std::map<int, Pose2> motion;
  for (const auto& [number, pairs_of_part] : pairs) {
    std::vector<int> all(pairs_of_part.size());
    std::iota(all.begin(), all.end(), 0);
    const auto fit = pairs_of_part.size() > 1 ? FitRigid(pairs_of_part, all) : std::nullopt;
    if (fit) {
      motion.emplace(number, *fit);
    }
  }
  for (std::size_t i = 0; i < graph->map_from_base.size() && !motion.empty(); ++i) {
    const auto own = motion.find(part[i]);
    graph->map_from_base[i] = (own != motion.end() ? own : motion.begin())->second * graph->map_from_base[i];
  }
}

}  // namespace

void AddAbsoluteConstraints(const std::vector<BuildFrame>& frames, const std::vector<LoadedSurvey>& surveys,
                            PoseGraph* graph) {
  std::vector<KnownPoint> known = AddPriors(frames, graph);
  const std::vector<KnownPoint> controlled = AddControlPoints(frames, surveys, graph);
  known.insert(known.end(), controlled.begin(), controlled.end());
  if (known.size() == 1) {
    throw InputError("one control point or pose does not fix the map's position and heading; give at least two");
  }
  AlignParts(known, graph);
}

}  // namespace floorloc
