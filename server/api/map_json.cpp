// SPDX-License-Identifier: Apache-2.0
#include "server/api/map_json.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "server/api/camera_json.h"
#include "server/serving/map_quality.h"
#include "server/wire/strict_json.h"

namespace floorloc {
namespace {

nlohmann::json FormatExtent(const RectM& extent) {
  return {{"x_min", extent.x_min}, {"x_max", extent.x_max}, {"y_min", extent.y_min}, {"y_max", extent.y_max}};
}

nlohmann::json FormatExtractor(const ExtractorOptions& options) {
  return {{"type", ToString(options.type)},
          {"max_keypoints", options.max_keypoints},
          {"cell_px", options.cell_px},
          {"levels", options.levels},
          {"scale_factor", options.scale_factor},
          {"threshold", options.threshold},
          {"normalize_radius_px", options.normalize_radius_px},
          {"smooth_sigma_px", options.smooth_sigma_px}};
}

nlohmann::json FormatMosaic(const MosaicLayout& mosaic) {
  return {{"tile_px", mosaic.tile_px}, {"max_zoom", mosaic.max_zoom}, {"resolution", mosaic.resolution_m}};
}

nlohmann::json FormatOneVersion(const MapVersion& version, const std::string& active) {
  return {{"version", version.version},
          {"active", version.version == active},
          {"id", version.id},
          {"created", version.created},
          {"builder_version", version.builder_version},
          {"parents", version.parents},
          {"area_m2", version.area_m2},
          {"bytes", version.bytes},
          {"added", version.added_s},
          {"origin", version.origin}};
}

nlohmann::json OrNull(const std::string& text) { return text.empty() ? nlohmann::json() : nlohmann::json(text); }

// What a server that keeps no versions serves is one too.
nlohmann::json FormatVersionList(const LoadedMap& map, const MapLibrary& library) {
  MapVersions versions = library.Versions(map.name).value_or(MapVersions());
  const std::string active = map.ready() ? map.info().content_version : "";
  if (map.ready() && versions.Find(active) == nullptr) {
    MapVersion served = DescribeVersion(map.info());
    served.bytes = map.opened->bytes();
    served.added_s = map.opened->modified_s();
    served.origin = "folder";
    versions.versions.push_back(std::move(served));
  }
  nlohmann::json list = nlohmann::json::array();
  for (auto version = versions.versions.rbegin(); version != versions.versions.rend(); ++version) {
    list.push_back(FormatOneVersion(*version, active));
  }
  return {{"map", map.name},
          {"active", OrNull(active)},
          {"previous", OrNull(versions.previous)},
          {"versions", std::move(list)}};
}

// What is wrong with the file in the folder while an older version is served.
void AddRefused(const MapLibrary& library, const std::string& name, nlohmann::json* json) {
  if (const auto refused = library.Refused(name)) {
    (*json)["refused_file"] = {{"code", refused->code}, {"error", refused->error}};
  }
}

nlohmann::json FormatSummary(const LoadedMap& map) {
  if (!map.ready()) {
    return {{"name", map.name}, {"status", "error"}, {"code", map.error_code}, {"error", map.error}};
  }
  const MapInfo& info = map.info();
  const FloorMap& content = map.localizer->map();
  return {
      {"name", map.name},
      {"status", "ready"},
      {"id", info.id},
      {"version", info.content_version},
      {"created", info.created},
      {"builder_version", info.builder_version},
      {"frame", "map"},
      {"resolution", info.resolution_m},
      {"extent", FormatExtent(info.extent)},
      {"area_m2", info.area_m2},
      {"layers",
       {{{"name", "floor"}, {"extractor", ToString(info.extractor.type)}, {"keypoints", content.keypoints.size()}}}},
      {"mosaic", FormatMosaic(content.mosaic)}};
}

// The builder writes JSON objects; a map written by another program may hold any text. Null when it is not JSON.
nlohmann::json EmbeddedJson(const std::string& text) {
  nlohmann::json value = nlohmann::json::parse(text, nullptr, false);
  return value.is_discarded() ? nlohmann::json() : value;
}

// How well the scale is known, from the build's report. Null: a map that does not say it.
nlohmann::json FormatScale(const MapInfo& info) {
  const nlohmann::json report = EmbeddedJson(info.report_json);
  const nlohmann::json scale = report.is_object() ? report.value("scale", nlohmann::json()) : nlohmann::json();
  if (!scale.is_object() || !scale.contains("sigma") || !scale["sigma"].is_number() || !(scale["sigma"] > 0.0)) {
    return {};
  }
  nlohmann::json sources = nlohmann::json::array();
  for (const nlohmann::json& source : scale.value("sources", nlohmann::json::array())) {
    if (source.is_object() && source.contains("name") && source["name"].is_string()) {
      sources.push_back(source["name"]);
    }
  }
  return {{"sigma", scale["sigma"]}, {"sources", std::move(sources)}};
}

// The region with the most floor, which localization uses. Null: nowhere, or a map that does not say it.
nlohmann::json FormatLattice(const MapInfo& info) {
  if (info.lattices.empty()) {
    return {};
  }
  const MapLattice& lattice = info.lattices.front();
  const auto& basis = lattice.basis;
  return {{"basis", {{basis(0, 0), basis(1, 0)}, {basis(0, 1), basis(1, 1)}}},
          {"point", {lattice.point_m.x(), lattice.point_m.y()}},
          {"residual_m", lattice.residual_m},
          {"share", lattice.share},
          {"floor_share", lattice.floor_share},
          {"extent", FormatExtent(lattice.extent)}};
}

}  // namespace

std::string FormatVersions(const LoadedMap& map, const MapLibrary& library) {
  return ToText(FormatVersionList(map, library));
}

std::string FormatVersion(const MapVersion& version, const std::string& active) {
  return ToText(FormatOneVersion(version, active));
}

std::string FormatActivation(const MapChange& change) {
  return ToText({{"map", change.map},
                 {"version", change.version},
                 {"previous", OrNull(change.previous)},
                 {"vehicles", {{"kept", change.kept}, {"lost", change.lost}}}});
}

std::string FormatMapList(const std::vector<std::shared_ptr<const LoadedMap>>& maps, const MapLibrary& library) {
  nlohmann::json list = nlohmann::json::array();
  for (const auto& map : maps) {
    list.push_back(FormatSummary(*map));
    AddRefused(library, map->name, &list.back());
  }
  return ToText({{"maps", std::move(list)}});
}

std::string FormatMap(const LoadedMap& map, const MapLibrary& library) {
  nlohmann::json json = FormatSummary(map);
  AddRefused(library, map.name, &json);
  json["versions"] = FormatVersionList(map, library)["versions"];
  if (map.ready()) {
    const MapInfo& info = map.info();
    if (nlohmann::json scale = FormatScale(info); !scale.is_null()) {
      json["scale"] = std::move(scale);
    }
    json["lattice"] = FormatLattice(info);
    json["format_version"] = info.format_version;
    json["extractor"] = FormatExtractor(info.extractor);
    json["camera"] = FormatCamera(info.camera().camera);
    json["floor"] = FormatFloor(info.camera().floor);
  }
  return ToText(json);
}

std::string FormatQuality(const LoadedMap& map) {
  constexpr double kCellM = 1.0;
  nlohmann::json cells = nlohmann::json::array();
  for (const QualityCell& cell : MeasureQuality(map.localizer->map().keypoints, kCellM)) {
    cells.push_back({{"x", kCellM * cell.x},
                     {"y", kCellM * cell.y},
                     {"keypoints", cell.keypoints},
                     {"observations", cell.observations},
                     {"distinctiveness", cell.distinctiveness}});
  }
  return ToText({{"map", map.name},
                 {"map_version", map.info().content_version},
                 {"cell_m", kCellM},
                 {"cells", std::move(cells)}});
}

std::string FormatSuccess(const LoadedMap& map, const SuccessMap& counted) {
  const MapSuccess success = counted.Of(map.name, map.info().content_version);
  nlohmann::json squares = nlohmann::json::array();
  for (const SuccessSquare& square : success.squares) {
    squares.push_back({{"x", success.square_m * square.x},
                       {"y", success.square_m * square.y},
                       {"found", square.found},
                       {"missed", square.missed},
                       {"inliers", static_cast<double>(square.inliers) /
                                       static_cast<double>(std::max<std::int64_t>(1, square.found))},
                       {"survey_again", MustSurveyAgain(square, counted.options())}});
  }
  return ToText({{"map", map.name},
                 {"map_version", success.version},
                 {"since", success.since_s > 0.0 ? nlohmann::json(success.since_s) : nlohmann::json()},
                 {"cell_m", success.square_m},
                 {"unplaced", success.unplaced},
                 {"cells", std::move(squares)}});
}

std::string FormatReport(const LoadedMap& map) {
  const nlohmann::json report = EmbeddedJson(map.info().report_json);
  return report.is_object() ? ToText(report) : "{}";
}

}  // namespace floorloc
