// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/finished_map/map_diff.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <queue>
#include <tuple>

#include "core/map/extractor_parameters.h"
#include "mapbuilder/coverage/coverage.h"
#include "mapbuilder/finished_map/same_points.h"
#include "mapbuilder/finished_map/survey_provenance.h"

namespace floorloc {
namespace {

struct LoadedMap {
  explicit LoadedMap(const MapDatabase& database)
      : map(database.ReadMap()), frames(database.ReadFrames()), coverage(MakeCoverage()) {
    for (const SurveyProvenance& survey : ReadProvenance(map.info)) {
      survey_names.push_back(survey.folder);
    }
  }

  CoverageGrid MakeCoverage() const {
    std::vector<std::optional<Pose2>> poses;
    std::vector<RectM> floors;
    for (const MapFrame& frame : frames) {
      poses.emplace_back(frame.map_from_base);
      floors.push_back(map.info.cameras[static_cast<std::size_t>(frame.survey)].floor.roi);
    }
    return {poses, floors};
  }

  FloorMap map;
  std::vector<MapFrame> frames;
  CoverageGrid coverage;
  std::vector<std::string> survey_names;  // folders
};

std::string RelationOf(const MapInfo& before, const MapInfo& after) {
  if (before.content_version == after.content_version) {
    return "same content";
  }
  for (const MapParent& parent : after.parents) {
    if (parent.content_version == before.content_version) {
      return parent.relation;
    }
  }
  for (const MapParent& parent : before.parents) {
    if (parent.content_version == after.content_version) {
      return parent.relation == "extends" ? "is extended by" : "is merged into";
    }
  }
  return before.id == after.id ? "another version" : "another map";
}

void CompareFrames(const LoadedMap& before, const LoadedMap& after, MapDiff* diff) {
  using Name = std::tuple<std::string, std::string, std::int64_t>;
  const auto name_of = [](const LoadedMap& map, const MapFrame& frame) {
    return Name(map.survey_names[static_cast<std::size_t>(frame.survey)], frame.filename, frame.stamp_ns);
  };
  std::map<Name, std::queue<Pose2>> old_poses;  // several of one name where a map has a survey twice
  for (const MapFrame& frame : before.frames) {
    old_poses[name_of(before, frame)].push(frame.map_from_base);
  }
  double squares = 0.0;
  for (const MapFrame& frame : after.frames) {
    const auto old = old_poses.find(name_of(after, frame));
    if (old == old_poses.end() || old->second.empty()) {
      ++diff->frames_added;
      continue;
    }
    ++diff->frames_kept;
    const Pose2 old_pose = old->second.front();
    old->second.pop();
    const Pose2 motion = old_pose.Between(frame.map_from_base);
    const double moved_m = motion.translation().norm();
    squares += moved_m * moved_m;
    diff->moves.max_rad = std::max(diff->moves.max_rad, std::abs(motion.yaw()));
    if (moved_m > diff->moves.max_m) {
      diff->moves.max_m = moved_m;
      diff->moves.farthest = frame.filename;
      diff->moves.farthest_pose = old_pose;
    }
  }
  diff->frames_removed = static_cast<int>(before.frames.size()) - diff->frames_kept;
  diff->moves.rms_m = std::sqrt(squares / std::max(1, diff->frames_kept));
}

std::optional<MapDiff::Keypoints> CompareKeypoints(const FloorMap& before, const FloorMap& after) {
  const cv::Mat& a = before.keypoints.descriptors;
  const cv::Mat& b = after.keypoints.descriptors;
  if (before.info.extractor.type != after.info.extractor.type || a.type() != b.type() || a.cols != b.cols) {
    return std::nullopt;
  }
  MapDiff::Keypoints count;
  count.kept = static_cast<int>(
      FindSamePoints(before.keypoints, after.keypoints, before.info.camera().floor.resolution_m).size());
  count.gone = static_cast<int>(before.keypoints.size()) - count.kept;
  count.added = static_cast<int>(after.keypoints.size()) - count.kept;
  return count;
}

class ParameterList {
 public:
  void Compare(const std::string& name, const std::string& before, const std::string& after) {
    if (before != after) {
      differences_.push_back({name, before, after});
    }
  }
  void Compare(const std::string& name, double before, double after) { Compare(name, Text(before), Text(after)); }
  std::vector<Difference> Take() { return std::move(differences_); }

 private:
  static std::string Text(double number) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.9g", number);
    return text;
  }
  std::vector<Difference> differences_;
};

void CompareCameras(const std::string& survey, const FloorCamera& a, const FloorCamera& b, ParameterList* list) {
  const std::string prefix = "camera of " + survey + ": ";
  const auto compare = [&](const char* name, double before, double after) {
    list->Compare(prefix + name, before, after);
  };
  list->Compare(prefix + "distortion_model", ToString(a.camera.distortion_model), ToString(b.camera.distortion_model));
  compare("fx", a.camera.fx, b.camera.fx);
  compare("fy", a.camera.fy, b.camera.fy);
  compare("cx", a.camera.cx, b.camera.cx);
  compare("cy", a.camera.cy, b.camera.cy);
  for (std::size_t i = 0; i < std::min(a.camera.distortion.size(), b.camera.distortion.size()); ++i) {
    compare(("distortion " + std::to_string(i)).c_str(), a.camera.distortion[i], b.camera.distortion[i]);
  }
  for (int i = 0; i < 9; ++i) {
    compare(("homography " + std::to_string(i)).c_str(), a.floor.base_from_pixel(i / 3, i % 3),
            b.floor.base_from_pixel(i / 3, i % 3));
  }
  compare("roi x_min", a.floor.roi.x_min, b.floor.roi.x_min);
  compare("roi x_max", a.floor.roi.x_max, b.floor.roi.x_max);
  compare("roi y_min", a.floor.roi.y_min, b.floor.roi.y_min);
  compare("roi y_max", a.floor.roi.y_max, b.floor.roi.y_max);
  compare("resolution", a.floor.resolution_m, b.floor.resolution_m);
}

std::vector<Difference> CompareParameters(const LoadedMap& before, const LoadedMap& after) {
  ParameterList list;
  list.Compare("builder", before.map.info.builder_version, after.map.info.builder_version);
  const std::map<std::string, std::string> old_options = ToParameters(before.map.info.extractor);
  for (const auto& [name, value] : ToParameters(after.map.info.extractor)) {
    list.Compare("extractor " + name, old_options.at(name), value);
  }
  list.Compare("mosaic resolution", before.map.mosaic.resolution_m, after.map.mosaic.resolution_m);
  for (std::size_t i = 0; i < before.survey_names.size(); ++i) {
    const auto same = std::find(after.survey_names.begin(), after.survey_names.end(), before.survey_names[i]);
    if (same != after.survey_names.end()) {
      CompareCameras(*same, before.map.info.cameras[i],
                     after.map.info.cameras[static_cast<std::size_t>(same - after.survey_names.begin())], &list);
    }
  }
  return list.Take();
}

}  // namespace

MapDiff CompareMaps(const MapDatabase& before_map, const MapDatabase& after_map) {
  const LoadedMap before(before_map);
  const LoadedMap after(after_map);
  MapDiff diff;
  diff.relation = RelationOf(before.map.info, after.map.info);
  diff.before_m2 = before.map.info.area_m2;
  diff.after_m2 = after.map.info.area_m2;
  diff.gained_m2 = after.coverage.AreaBeyondM2(before.coverage);
  diff.lost_m2 = before.coverage.AreaBeyondM2(after.coverage);
  CompareFrames(before, after, &diff);
  diff.keypoints = CompareKeypoints(before.map, after.map);
  diff.parameters = CompareParameters(before, after);
  return diff;
}

}  // namespace floorloc
