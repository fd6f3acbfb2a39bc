// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/absolute_constraints.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>

#include "core/io/input_error.h"
#include "core/registration/least_squares.h"
#include "mapbuilder/placement/spanning_forest.h"

namespace floorloc {
namespace {

// Points also agree within this many of their standard deviations.
constexpr double kAgreeSigmas = 3.0;

// A point of a frame: where the graph has it (source) and where the map has it (target).
struct PointOfFrame {
  int frame = 0;
  OrientedMatch pair;
};

std::vector<PointOfFrame> AddPriors(const std::vector<BuildFrame>& frames, PoseGraph* graph) {
  std::vector<PointOfFrame> known;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (const auto& prior = frames[i].prior) {
      const int frame = static_cast<int>(i);
      graph->priors.push_back({frame, prior->map_from_base, prior->covariance});
      known.push_back({frame, {graph->map_from_base[i].translation(), prior->map_from_base.translation(), 0.0, 0.0}});
    }
  }
  return known;
}

// A control point of a survey as a factor of the graph.
struct SurveyPoint {
  int survey = 0;
  int point = 0;
  ControlPointFactor factor;
};

std::vector<SurveyPoint> CollectControlPoints(const std::vector<BuildFrame>& frames,
                                              const std::vector<LoadedSurvey>& surveys) {
  std::map<std::pair<int, std::string>, int> by_name;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    by_name[{frames[i].survey, frames[i].info.filename}] = static_cast<int>(i);
  }
  std::vector<SurveyPoint> points;
  for (std::size_t s = 0; s < surveys.size(); ++s) {
    const Survey& survey = surveys[s].survey;
    for (std::size_t i = 0; i < survey.control_points.size(); ++i) {
      const ControlPoint& point = survey.control_points[i];
      ControlPointFactor factor;
      factor.frame = by_name.at({static_cast<int>(s), point.filename});
      factor.point_in_base_m = FloorPointOf(frames[static_cast<std::size_t>(factor.frame)], surveys, point.raw_px);
      factor.point_in_map_m = point.point_in_map_m;
      factor.sigma_m = point.sigma_m.value_or(factor.sigma_m);
      points.push_back({static_cast<int>(s), static_cast<int>(i), factor});
    }
  }
  return points;
}

std::string Metres(double m) {
  char text[32];
  std::snprintf(text, sizeof(text), m < 0.1 ? "%.3f m" : "%.2f m", m);
  return text;
}

double Largest(const std::vector<double>& values) { return *std::max_element(values.begin(), values.end()); }

// what: the subject, plural.
std::string Refusal(const KnownPointFit& fit, const std::string& what) {
  const std::string off = what + " contradict the images by up to " + Metres(Largest(fit.misfit_m));
  if (fit.status == KnownPointFit::Status::kFitsOtherwise) {
    return "fits when " + fit.when + ": as given, " + off +
           "; the map's frame is in metres and right-handed, seen from above y points to the left of x";
  }
  return off + ", and no half of them agrees; check their names, pixels and coordinates, and the scale of floor.yaml";
}

// Odometry does not tell the relative pose of two parts precisely enough to contradict a surveyed point.
std::vector<int> PartsByImages(const PoseGraph& graph) {
  return FindComponents(static_cast<int>(graph.map_from_base.size()), graph.links);
}

// Control points of one survey in one part of the graph, checked against each other.
struct PointGroup {
  std::vector<SurveyPoint> points;
  std::vector<KnownPoint> known;
};

std::map<std::pair<int, int>, PointGroup> GroupPoints(const std::vector<SurveyPoint>& points,
                                                      const std::vector<LoadedSurvey>& surveys,
                                                      const PoseGraph& graph) {
  const std::vector<int> part = PartsByImages(graph);
  std::map<std::pair<int, int>, PointGroup> groups;
  for (const SurveyPoint& point : points) {
    const Survey& survey = surveys[static_cast<std::size_t>(point.survey)].survey;
    if (!survey.control_points[static_cast<std::size_t>(point.point)].of_marker) {
      const auto frame = static_cast<std::size_t>(point.factor.frame);
      PointGroup& group = groups[{point.survey, part[frame]}];
      group.points.push_back(point);
      group.known.push_back({graph.map_from_base[frame] * point.factor.point_in_base_m, point.factor.point_in_map_m});
    }
  }
  return groups;
}

ControlPointFindings CheckControlPoints(const std::vector<SurveyPoint>& points,
                                        const std::vector<LoadedSurvey>& surveys, const KnownPointOptions& options,
                                        const PoseGraph& graph) {
  ControlPointFindings findings;
  for (const auto& [key, group] : GroupPoints(points, surveys, graph)) {
    KnownPointOptions tolerant = options;
    for (const SurveyPoint& point : group.points) {
      tolerant.agree_m = std::max(tolerant.agree_m, kAgreeSigmas * point.factor.sigma_m);
    }
    const KnownPointFit fit = FitKnownPoints(group.known, tolerant);
    if (fit.status != KnownPointFit::Status::kFits) {
      const std::string what = "its " + std::to_string(group.known.size()) + " points";
      throw InputError(surveys[static_cast<std::size_t>(key.first)].survey.control_point_file, Refusal(fit, what));
    }
    for (const std::size_t i : fit.disagreeing) {
      findings.left_out.push_back({group.points[i].survey, group.points[i].point, fit.misfit_m[i]});
    }
    findings.scale = std::abs(std::log(fit.scale)) > std::abs(std::log(findings.scale)) ? fit.scale : findings.scale;
  }
  return findings;
}

// Poses of another system are only checked for wrong axes and units: their noise is known, and single ones may be off.
void CheckPriors(const std::vector<PointOfFrame>& priors, const KnownPointOptions& options, const PoseGraph& graph) {
  const std::vector<int> part = PartsByImages(graph);
  std::map<int, std::vector<KnownPoint>> groups;
  for (const PointOfFrame& prior : priors) {
    groups[part[static_cast<std::size_t>(prior.frame)]].push_back({prior.pair.source_m, prior.pair.target_m});
  }
  for (const auto& [number, points] : groups) {
    const KnownPointFit fit = FitKnownPoints(points, options);
    if (fit.status == KnownPointFit::Status::kFitsOtherwise) {
      throw InputError("the file of --poses " + Refusal(fit, "its positions"));
    }
  }
}

// Adds the points that were not left out.
std::vector<PointOfFrame> AddControlPoints(const std::vector<SurveyPoint>& points, const ControlPointFindings& findings,
                                           PoseGraph* graph) {
  std::set<std::pair<int, int>> left_out;
  for (const LeftOutControlPoint& point : findings.left_out) {
    left_out.emplace(point.survey, point.point);
  }
  std::vector<PointOfFrame> known;
  for (const SurveyPoint& point : points) {
    if (!left_out.contains({point.survey, point.point})) {
      const ControlPointFactor& factor = point.factor;
      graph->control_points.push_back(factor);
      const Pose2& map_from_base = graph->map_from_base[static_cast<std::size_t>(factor.frame)];
      known.push_back({factor.frame, {map_from_base * factor.point_in_base_m, factor.point_in_map_m, 0.0, 0.0}});
    }
  }
  return known;
}

// Moves each part of the graph so that its own pairs agree. A part without any goes with the first part that has some.
void AlignParts(const std::vector<PointOfFrame>& known, PoseGraph* graph) {
  const auto count = static_cast<int>(graph->map_from_base.size());
  const std::vector<int> part = FindComponents(count, graph->LinksAndOdometry());
  std::map<int, std::vector<OrientedMatch>> pairs;
  for (const PointOfFrame& point : known) {
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

ControlPointFindings AddAbsoluteConstraints(const std::vector<BuildFrame>& frames,
                                            const std::vector<LoadedSurvey>& surveys, const KnownPointOptions& options,
                                            PoseGraph* graph) {
  const std::vector<SurveyPoint> points = CollectControlPoints(frames, surveys);
  ControlPointFindings findings = CheckControlPoints(points, surveys, options, *graph);
  std::vector<PointOfFrame> known = AddPriors(frames, graph);
  CheckPriors(known, options, *graph);
  const std::vector<PointOfFrame> controlled = AddControlPoints(points, findings, graph);
  known.insert(known.end(), controlled.begin(), controlled.end());
  if (known.size() == 1) {
    throw InputError("one control point or pose does not fix the map's position and heading; give at least two");
  }
  AlignParts(known, graph);
  return findings;
}

}  // namespace floorloc
