// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/build/place_surveys.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "core/io/input_error.h"
#include "mapbuilder/extend/extend_map.h"
#include "mapbuilder/heights/height_scale.h"
#include "mapbuilder/placement/placement_journal.h"

namespace floorloc {
namespace {

// Attaches each frame's pose from --poses as a prior.
FrameSet WithKnownPoses(FrameSet set, const Trajectory& poses, const PlacementOptions& options) {
  if (poses.empty()) {
    return set;
  }
  const Eigen::Vector3d sigma(options.prior_sigma_m, options.prior_sigma_m, options.prior_sigma_rad);
  int known = 0;
  for (BuildFrame& frame : set.frames) {
    if (const std::optional<Pose2> pose = InterpolatePose(poses, frame.info.stamp_ns)) {
      frame.prior = {*pose, sigma.cwiseAbs2().asDiagonal()};
      ++known;
    }
  }
  if (known == 0) {
    throw InputError("none of the --poses has the time of a survey frame; check that both use the same clock");
  }
  return set;
}

// Detects markers if a marker file is given. Masks the keypoints on them afterwards, since marker paper is not floor.
std::optional<MarkerSurvey> FindMarkers(const FrameSet& set, const BuildOptions& options) {
  if (options.markers.file.empty()) {
    return std::nullopt;
  }
  MarkerOptions with_shared = options.markers;
  with_shared.detection.run = options.run;
  return MarkerSurvey(with_shared, set);
}

// Journal key of a stage that runs after all features are known.
std::string KeyOf(const char* stage, const BuildOptions& options, const FrameSet& set) {
  return PlacementKey(set.surveys, stage + options.fingerprint, options.poses);
}

// Poses of the frames in the base map, restored from the journal if an earlier run found them.
std::vector<PosePriorFactor> LocateInMapOnce(const FrameSet& set, const BaseMap& base, const BuildOptions& options,
                                             BuildJournal* journal) {
  const std::string key = KeyOf("fixes", options, set);
  if (auto done = RestoreFixes(key, set.frames.size(), journal)) {
    return std::move(*done);
  }
  std::vector<PosePriorFactor> fixes = LocateInMap(base, set.surveys, set.frames, {options.run, options.seed});
  StoreFixes(fixes, key, journal);
  return fixes;
}

// PlaceFrames, restored from the journal if an earlier run did it.
Placement PlaceFramesOnce(const FrameSet& set, const BuildOptions& options, BuildJournal* journal) {
  const std::string key = KeyOf("placement", options, set);
  if (std::optional<Placement> done = RestorePlacement(key, set.frames.size(), journal)) {
    return std::move(*done);
  }
  Placement placement = PlaceFrames(set.frames, set.surveys, options.placement);
  StorePlacement(placement, key, journal);
  return placement;
}

// Images tell ratios of heights only: the frames are placed once without the known lengths, to be scaled by them.
void ScaleHeightsByKnownLengths(const BuildOptions& options, PlacedSurveys* placed) {
  const auto known = [](const LoadedSurvey& loaded) {
    return loaded.survey.control_points.size() > 1 || !loaded.survey.known_distances.empty();
  };
  FrameSet& set = placed->set;
  const bool own_heights = std::any_of(set.frames.begin(), set.frames.end(),
                                       [](const BuildFrame& frame) { return frame.height_ratio != 1.0; });
  if (!own_heights || std::none_of(set.surveys.begin(), set.surveys.end(), known)) {
    return;
  }
  std::vector<LoadedSurvey> without = set.surveys;
  for (LoadedSurvey& loaded : without) {
    loaded.survey.control_points.clear();
  }
  const Placement placement = PlaceFrames(set.frames, without, options.placement);
  if (const auto factor = ScaleByKnownLengths(set, placement.map_from_base)) {
    MultiplyHeights(*factor, &set);
    if (placed->markers) {
      placed->markers->MultiplyHeights(*factor, set);
    }
    placed->height_factor = *factor;
  }
}

// Places the frames again without any marker that contradicts the others.
PlacedSurveys PlaceWithMarkers(PlacedSurveys placed, const BuildOptions& options, BuildJournal* journal) {
  MarkerSurvey& markers = *placed.markers;
  placed.placement = PlaceFramesOnce(placed.set, options, journal);
  if (markers.ExcludeContradicting(placed.set.frames, placed.placement)) {
    placed.set = markers.AddControlPoints(std::move(placed.set));
    BuildOptions without = options;
    without.fingerprint += "contradicting markers left out\n";
    placed.placement = PlaceFramesOnce(placed.set, without, journal);
  }
  placed.set = markers.MaskInMap(placed.placement, std::move(placed.set));
  return placed;
}

// Control points that the others contradict are named, and no later stage sees them.
void RemoveContradictedPoints(PlacedSurveys* placed) {
  std::vector<LeftOutControlPoint> left_out = placed->placement.control_points.left_out;
  std::sort(left_out.begin(), left_out.end(), [](const LeftOutControlPoint& a, const LeftOutControlPoint& b) {
    return std::pair(a.survey, a.point) > std::pair(b.survey, b.point);
  });
  for (const LeftOutControlPoint& out : left_out) {
    Survey& survey = placed->set.surveys.at(static_cast<std::size_t>(out.survey)).survey;
    const ControlPoint& point = survey.control_points.at(static_cast<std::size_t>(out.point));
    char off[96];
    std::snprintf(off, sizeof(off), "(%.3f, %.3f) is %.2f m off", point.point_in_map_m.x(), point.point_in_map_m.y(),
                  out.misfit_m);
    placed->warnings.push_back(survey.control_point_file.string() + ": the point of " + point.filename + " at " + off +
                               " against the others, and not used; check its name, pixel and position");
    survey.control_points.erase(survey.control_points.begin() + out.point);
  }
}

}  // namespace

PlacedSurveys PlaceSurveys(FrameSet set, const BuildOptions& options, const BaseMap* base, BuildJournal* journal) {
  PlacedSurveys placed;
  placed.set = WithKnownPoses(std::move(set), options.poses, options.placement);
  placed.markers = FindMarkers(placed.set, options);
  if (placed.markers) {
    placed.set = placed.markers->AddControlPoints(placed.markers->MaskDetected(std::move(placed.set)));
  }
  if (base != nullptr) {
    const std::vector<PosePriorFactor> fixes = LocateInMapOnce(placed.set, *base, options, journal);
    placed.base_file = base->file.filename().string();
    placed.found_in_base = static_cast<int>(fixes.size());
    placed.warnings = base->LayersLeftBehind();
    placed.set = AlignToMap(*base, fixes, std::move(placed.set));
  }
  ScaleHeightsByKnownLengths(options, &placed);
  if (placed.markers) {
    placed = PlaceWithMarkers(std::move(placed), options, journal);
  } else {
    placed.placement = PlaceFramesOnce(placed.set, options, journal);
  }
  RemoveContradictedPoints(&placed);
  return placed;
}

}  // namespace floorloc
