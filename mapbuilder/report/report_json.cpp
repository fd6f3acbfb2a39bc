// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/report_json.h"

#include <nlohmann/json.hpp>

#include "mapbuilder/build/build_report.h"
#include "mapbuilder/finished_map/map_lattices.h"
#include "mapbuilder/report/number_text.h"
#include "mapbuilder/report/odometry_drift.h"
#include "mapbuilder/report/weakness_text.h"

namespace floorloc {
namespace {

using Json = nlohmann::ordered_json;

Json RectJson(const RectM& rect) {
  return {{"x_min", rect.x_min}, {"x_max", rect.x_max}, {"y_min", rect.y_min}, {"y_max", rect.y_max}};
}

Json QuantilesJson(const std::vector<double>& values) {
  return {{"median", Quantile(values, 0.5)}, {"p95", Quantile(values, 0.95)}, {"max", Quantile(values, 1.0)}};
}

Json MapJson(const MapEvidence& evidence) {
  const MapInfo& info = evidence.map.info;
  return {{"name", info.name},
          {"id", info.id},
          {"content_version", info.content_version},
          {"created", info.created},
          {"builder_version", info.builder_version},
          {"extent", RectJson(info.extent)},
          {"surveys", Json::parse(info.surveys_json, nullptr, false)},
          {"frames", evidence.frames.size()},
          {"links", evidence.links.size()},
          {"keypoints", evidence.map.keypoints.size()}};
}

Json ZonesJson(const MapQuality& quality) {
  Json zones = Json::array();
  for (std::size_t i = 0; i < quality.zones.size(); ++i) {
    const Zone& zone = quality.zones[i];
    zones.push_back({{"number", i + 1},
                     {"reason", Key(zone.weakness)},
                     {"x", zone.mark.x()},
                     {"y", zone.mark.y()},
                     {"area_m2", zone.area_m2},
                     {"box", RectJson(zone.box)},
                     {"usable_keypoints_in_view", zone.usable_in_view},
                     {"held_out_failures", zone.held_out_failures},
                     {"lost_frames", zone.lost_frames},
                     {"importance", zone.importance},
                     {"advice", Advice(zone)}});
  }
  return zones;
}

Json FloorJson(const MapQuality& quality) {
  std::vector<double> coverage, usable, distinct, density;
  for (std::size_t cell = 0; cell < quality.grid.size(); ++cell) {
    if (quality.coverage[cell] > 0) {
      coverage.push_back(quality.coverage[cell]);
      density.push_back(static_cast<double>(quality.keypoints_m2[cell]));
    }
    if (quality.usable_in_view[cell] >= 0.0F) {
      usable.push_back(static_cast<double>(quality.usable_in_view[cell]));
    }
    if (quality.distinctiveness[cell] >= 0.0F) {
      distinct.push_back(static_cast<double>(quality.distinctiveness[cell]));
    }
  }
  const auto low = [](const std::vector<double>& values) -> Json {
    return {{"p5", Quantile(values, 0.05)}, {"median", Quantile(values, 0.5)}, {"p95", Quantile(values, 0.95)}};
  };
  return {{"surveyed_m2", quality.surveyed_m2},
          {"weak_m2", quality.weak_m2},
          {"large_holes_m2", quality.furniture_m2},
          {"cell_m", quality.grid.cell_m()},
          {"view_m2", quality.view_m2},
          {"frames_per_cell", low(coverage)},
          {"keypoints_per_m2", low(density)},
          {"usable_keypoints_in_view", low(usable)},
          {"distinctiveness", low(distinct)}};
}

Json GeometryJson(const MapEvidence& evidence, const MapQuality& quality) {
  std::vector<double> errors, sigmas, points;
  for (const LinkStrain& strain : quality.link_strain) {
    errors.push_back(strain.error_m);
    sigmas.push_back(strain.sigma);
  }
  for (const ControlPointError& point : evidence.build.control_points) {
    points.push_back((point.observed_m - point.surveyed_m).norm());
  }
  Json drifts = Json::array();
  for (const OdometryDrift& drift : FollowOdometry(evidence)) {
    drifts.push_back({{"survey", drift.survey},
                      {"travelled_m", drift.travelled_m},
                      {"largest_m", drift.largest_m},
                      {"largest_rad", drift.largest_rad}});
  }
  Json control = QuantilesJson(points);
  control["count"] = points.size();
  control["rms_m"] = ControlPointRms(evidence.build.control_points);
  return {{"link_error_m", QuantilesJson(errors)},
          {"link_sigma", QuantilesJson(sigmas)},
          {"odometry_drift", drifts},
          {"control_points", control}};
}

Json CopiesJson(const MapEvidence& evidence) {
  Json copies = Json::array();
  for (const CameraCopies& of_survey : evidence.copies) {
    copies.push_back({{"survey", of_survey.survey}, {"share_of_view", of_survey.share}, {"frames", of_survey.frames}});
  }
  return copies;
}

Json HeldOutJson(const MapEvidence& evidence) {
  const HeldOutScore score = ScoreHeldOut(evidence.build.held_out);
  return {{"frames", score.frames},
          {"localized", score.localized},
          {"ambiguous", score.ambiguous},
          {"wrong", score.wrong},
          {"not_localized", score.frames - score.localized - score.ambiguous - score.wrong},
          {"median_m", score.median_m},
          {"p95_m", score.p95_m},
          {"median_rad", score.median_rad}};
}

}  // namespace

std::string ReportJson(const MapEvidence& evidence, const MapQuality& quality, const Verdict& verdict) {
  const Json json{{"verdict", ToString(verdict.trust)},
                  {"headline", verdict.headline},
                  {"reasons", verdict.reasons},
                  {"facts", verdict.facts},
                  {"warnings", AllWarnings(evidence.build)},
                  {"resurvey", ZonesJson(quality)},
                  {"map", MapJson(evidence)},
                  {"floor", FloorJson(quality)},
                  {"geometry", GeometryJson(evidence, quality)},
                  {"lattices", LatticesJson(evidence.map.info.lattices)},
                  {"held_out", HeldOutJson(evidence)},
                  {"camera_copies", CopiesJson(evidence)},
                  {"build", Json::parse(evidence.map.info.report_json)}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace floorloc
