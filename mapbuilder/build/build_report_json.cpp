// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/map/map_error.h"
#include "mapbuilder/build/build_report.h"
#include "mapbuilder/finished_map/map_lattices.h"
#include "mapbuilder/self_calibration/calibration_summary.h"

namespace floorloc {
namespace {

using Json = nlohmann::ordered_json;

Json PoseJson(const Pose2& pose) { return {{"x", pose.x()}, {"y", pose.y()}, {"yaw", pose.yaw()}}; }

Pose2 PoseFrom(const Json& json) { return {json.at("x"), json.at("y"), json.at("yaw")}; }

Json ToJson(const DroppedFrame& frame) {
  Json json{{"filename", frame.filename}, {"reason", frame.reason}};
  if (frame.near) {
    json["near"] = PoseJson(*frame.near);
  }
  return json;
}

DroppedFrame DroppedFrom(const Json& json) {
  DroppedFrame frame{json.at("filename"), json.at("reason")};
  if (json.contains("near")) {
    frame.near = PoseFrom(json.at("near"));
  }
  return frame;
}

Json ToJson(const CameraDoubt& doubt) {
  return {{"bend_rms_m", doubt.bend_rms_m},
          {"bend_largest_m", doubt.bend_largest_m},
          {"pose_rms_m", doubt.pose_rms_m},
          {"camera_px", doubt.camera_px}};
}

CameraDoubt CameraDoubtFrom(const Json& json) {
  return {json.at("bend_rms_m"), json.at("bend_largest_m"), json.at("pose_rms_m"), json.at("camera_px")};
}

Json ToJson(const HeldOutFrame& frame) {
  Json json{{"filename", frame.filename}, {"pose", PoseJson(frame.map_from_base)}, {"status", frame.status}};
  if (!frame.reason.empty()) {
    json["reason"] = frame.reason;
  }
  json.update({{"error_m", frame.error_m},
               {"error_rad", frame.error_rad},
               {"keypoints", frame.keypoints},
               {"inliers", frame.inliers}});
  return json;
}

HeldOutFrame HeldOutFrom(const Json& json) {
  return {json.at("filename"), PoseFrom(json.at("pose")), json.at("status"),    json.value("reason", ""),
          json.at("error_m"),  json.at("error_rad"),      json.at("keypoints"), json.at("inliers")};
}

Json ToJson(const ControlPointError& point) {
  return {{"filename", point.filename},     {"x", point.surveyed_m.x()},      {"y", point.surveyed_m.y()},
          {"seen_x", point.observed_m.x()}, {"seen_y", point.observed_m.y()}, {"sigma", point.sigma_m}};
}

ControlPointError ControlPointFrom(const Json& json) {
  return {json.at("filename"), Eigen::Vector2d(json.at("x").get<double>(), json.at("y").get<double>()),
          Eigen::Vector2d(json.at("seen_x").get<double>(), json.at("seen_y").get<double>()),
          json.value("sigma", ControlPointError().sigma_m)};
}

Json ToJson(const FlatField& field) { return {{"columns", field.columns}, {"rows", field.rows}, {"gain", field.gain}}; }

FlatField FlatFieldFrom(const Json& json) {
  FlatField field{json.at("columns"), json.at("rows"), json.at("gain").get<std::vector<double>>()};
  if (field.columns < 1 || field.rows < 1 ||
      field.gain.size() != static_cast<std::size_t>(field.columns) * static_cast<std::size_t>(field.rows)) {
    throw MapError("the build report in the map has a flat field of wrong size; build the map again",
                   MapError::Kind::kDamaged);
  }
  return field;
}

Json ToJson(const CameraMaskFinding& mask) {
  return {{"status", ToString(mask.status)}, {"applied", mask.applied}, {"share", mask.share}, {"pairs", mask.pairs}};
}

CameraMaskFinding MaskFrom(const Json& json) {
  CameraMaskFinding mask;
  const auto status = ParseCameraMaskStatus(json.at("status").get<std::string>());
  if (!status) {
    throw MapError("the build report in the map has a camera mask of unknown status; build the map again",
                   MapError::Kind::kDamaged);
  }
  mask.status = *status;
  mask.applied = json.at("applied");
  mask.share = json.at("share");
  mask.pairs = json.at("pairs");
  return mask;
}

Json ToJson(const MarkerFit& marker) {
  return {{"id", marker.id},
          {"known", marker.known},
          {"used", marker.used},
          {"frames", marker.frames},
          {"error_m", marker.known ? Json(marker.error_m) : Json(nullptr)}};
}

MarkerFit MarkerFrom(const Json& json) {
  const Json& error_m = json.at("error_m");
  return {json.at("id"), json.at("known"), json.at("used"), json.at("frames"),
          error_m.is_null() ? 0.0 : error_m.get<double>()};
}

Json ToJson(const FrameHeights& heights) {
  Json json{{"free", heights.free}, {"spread", heights.spread}};
  if (heights.free) {
    json.update({{"asked", heights.asked},
                 {"lowest", heights.lowest},
                 {"highest", heights.highest},
                 {"scale_by", heights.scale_by}});
  }
  return json;
}

FrameHeights HeightsFrom(const Json& json) {
  FrameHeights heights;
  heights.free = json.at("free");
  heights.spread = json.at("spread");
  heights.asked = json.value("asked", heights.asked);
  heights.lowest = json.value("lowest", heights.lowest);
  heights.highest = json.value("highest", heights.highest);
  heights.scale_by = json.value("scale_by", heights.scale_by);
  return heights;
}

Json ToJson(const MapScale& scale) {
  Json json{{"sigma", scale.sigma}, {"span_m", scale.span_m}, {"better_m", scale.better_m}, {"sources", Json::array()}};
  for (const ScaleSource& source : scale.sources) {
    const double share = scale.sigma / source.sigma;
    json["sources"].push_back({{"name", source.name}, {"sigma", source.sigma}, {"weight", share * share}});
  }
  return json;
}

MapScale ScaleFrom(const Json& json) {
  MapScale scale{json.at("sigma"), json.at("span_m"), json.at("better_m"), {}};
  for (const Json& source : json.at("sources")) {
    scale.sources.push_back({source.at("name"), source.at("sigma")});
  }
  return scale;
}

Json ToJson(const DistanceMisfit& distance) {
  return {{"what", distance.what},
          {"known_m", distance.known_m},
          {"seen_m", distance.seen_m},
          {"sigma_m", distance.sigma_m}};
}

DistanceMisfit DistanceFrom(const Json& json) {
  return {json.at("what"), json.at("known_m"), json.at("seen_m"), json.at("sigma_m")};
}

template <typename T>
Json ListJson(const std::vector<T>& items) {
  Json json = Json::array();
  for (const T& item : items) {
    json.push_back(ToJson(item));
  }
  return json;
}

template <typename T>
std::vector<T> ListFrom(const Json& json, const char* name, T (*parse)(const Json&)) {
  std::vector<T> items;
  for (const Json& item : json.value(name, Json::array())) {
    items.push_back(parse(item));
  }
  return items;
}

// Counts, metres, radians and shares never exceed this bound, and below it all of them fit their types.
void CheckNumbers(const Json& json) {
  constexpr double kMaxNumber = 2147483647.0;
  if (json.is_number() && !(std::abs(json.get<double>()) <= kMaxNumber)) {
    throw MapError("the build report in the map is damaged (a number is out of range: " + json.dump() +
                       "); restore the map from a copy or build it again",
                   MapError::Kind::kDamaged);
  }
  if (json.is_structured()) {
    std::for_each(json.begin(), json.end(), CheckNumbers);
  }
}

void ReadNumbers(const Json& json, BuildReport* report) {
  report->frames = json.value("frames", report->frames);
  report->frames_used = json.value("frames_used", report->frames_used);
  report->extends = json.value("extends", report->extends);
  report->frames_found = json.value("frames_found", report->frames_found);
  report->warnings = json.value("warnings", report->warnings);
  report->part_sizes = json.value("parts", report->part_sizes);
  report->kept_all = json.value("kept_all", report->kept_all);
  report->repeats_unaided = json.value("repeats_unaided", report->repeats_unaided);
  report->links = json.value("links", report->links);
  report->rejected_links = json.value("rejected_links", report->rejected_links);
  report->overlapping_pairs = json.value("overlapping_pairs", report->overlapping_pairs);
  report->unmatched_pairs = json.value("unmatched_pairs", report->unmatched_pairs);
  report->link_rms_m = json.value("link_rms_m", report->link_rms_m);
  report->link_rms_sigma = json.value("link_rms_sigma", report->link_rms_sigma);
  report->drift_m = json.value("drift_m", report->drift_m);
  report->drift_rad = json.value("drift_rad", report->drift_rad);
  report->control_point_scale = json.value("control_point_scale", report->control_point_scale);
  if (json.contains("camera_doubt")) {
    report->camera_doubt = CameraDoubtFrom(json.at("camera_doubt"));
  }
  report->area_m2 = json.value("area_m2", report->area_m2);
  report->keypoints = json.value("keypoints", report->keypoints);
  report->mean_observations = json.value("mean_observations", report->mean_observations);
  if (json.contains("heights")) {
    report->heights = HeightsFrom(json.at("heights"));
  }
  if (json.contains("scale")) {
    report->scale = ScaleFrom(json.at("scale"));
  }
  if (json.contains("extent")) {
    const Json& extent = json.at("extent");
    report->extent = {extent.at("x_min"), extent.at("x_max"), extent.at("y_min"), extent.at("y_max")};
  }
}

}  // namespace

std::string ToJson(const BuildReport& report, bool with_times) {
  const RectM& extent = report.extent;
  Json json{
      {"frames", report.frames},
      {"frames_used", report.frames_used},
      {"dropped", ListJson(report.dropped)},
      {"warnings", report.warnings},
      {"parts", report.part_sizes},
      {"kept_all", report.kept_all},
      {"repeats_unaided", report.repeats_unaided},
      {"links", report.links},
      {"rejected_links", report.rejected_links},
      {"overlapping_pairs", report.overlapping_pairs},
      {"unmatched_pairs", report.unmatched_pairs},
      {"link_rms_m", report.link_rms_m},
      {"link_rms_sigma", report.link_rms_sigma},
      {"drift_m", report.drift_m},
      {"drift_rad", report.drift_rad},
      {"heights", ToJson(report.heights)},
      {"self_calibration", Json::parse(floorloc::ToJson(report.self_calibration))},
      {"camera_doubt", ToJson(report.camera_doubt)},
      {"scale", ToJson(report.scale)},
      {"known_distances", ListJson(report.distances)},
      {"area_m2", report.area_m2},
      {"extent", {{"x_min", extent.x_min}, {"x_max", extent.x_max}, {"y_min", extent.y_min}, {"y_max", extent.y_max}}},
      {"keypoints", report.keypoints},
      {"mean_observations", report.mean_observations},
      {"held_out", ListJson(report.held_out)},
      {"control_points", ListJson(report.control_points)},
      {"control_point_scale", report.control_point_scale},
      {"camera_masks", ListJson(report.masks)},
      {"markers", ListJson(report.markers)},
      {"flat_fields", ListJson(report.flat_fields)}};
  if (!report.extends.empty()) {
    json["extends"] = report.extends;
    json["frames_found"] = report.frames_found;
  }
  if (with_times) {
    json["content_version"] = report.content_version;
    json["lattices"] = LatticesJson(report.lattices);
    for (const auto& [stage, seconds] : report.stage_s) {
      json["stage_s"][stage] = seconds;
    }
    json["total_s"] = report.total_s;
    json["resumed_frames"] = report.resumed_frames;
    json["frames_per_s"] = report.total_s > 0.0 ? report.frames / report.total_s : 0.0;
  }
  return json.dump(2);
}

BuildReport ParseBuildReport(const std::string& text) {
  BuildReport report;
  try {
    const Json json = Json::parse(text);
    CheckNumbers(json);
    ReadNumbers(json, &report);
    report.dropped = ListFrom(json, "dropped", DroppedFrom);
    report.held_out = ListFrom(json, "held_out", HeldOutFrom);
    report.control_points = ListFrom(json, "control_points", ControlPointFrom);
    report.distances = ListFrom(json, "known_distances", DistanceFrom);
    report.masks = ListFrom(json, "camera_masks", MaskFrom);
    report.markers = ListFrom(json, "markers", MarkerFrom);
    report.flat_fields = ListFrom(json, "flat_fields", FlatFieldFrom);
  } catch (const nlohmann::json::exception& error) {
    throw MapError(std::string("the build report in the map is damaged (") + error.what() +
                       "); restore the map from a copy or build it again",
                   MapError::Kind::kDamaged);
  }
  return report;
}

}  // namespace floorloc
