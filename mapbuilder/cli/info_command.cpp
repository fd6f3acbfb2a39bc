// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/map/extractor_parameters.h"
#include "core/map/map_database.h"
#include "mapbuilder/bag/open_bag.h"
#include "mapbuilder/cli/bag_input.h"
#include "mapbuilder/cli/command.h"
#include "mapbuilder/cli/info_bag.h"
#include "mapbuilder/finished_map/map_lattices.h"

namespace floorloc {
namespace {

struct Arguments {
  std::filesystem::path map;
  SurveyChoice choice;
  bool json = false;
};

// Parsed JSON; null when the text is not valid JSON or has numbers that do not fit a double.
nlohmann::json Embedded(const std::string& text) {
  nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  return json.is_discarded() ? nlohmann::json() : json;
}

nlohmann::ordered_json ToJson(const FloorMap& map, std::size_t frames) {
  const MapInfo& info = map.info;
  nlohmann::ordered_json json{{"name", info.name},
                              {"id", info.id},
                              {"version", info.content_version},
                              {"format_version", info.format_version},
                              {"builder_version", info.builder_version},
                              {"created", info.created},
                              {"frame", "map"},
                              {"resolution_m", info.resolution_m},
                              {"extent",
                               {{"x_min", info.extent.x_min},
                                {"x_max", info.extent.x_max},
                                {"y_min", info.extent.y_min},
                                {"y_max", info.extent.y_max}}},
                              {"area_m2", info.area_m2},
                              {"frames", frames},
                              {"keypoints", map.keypoints.size()},
                              {"mosaic", {{"tile_px", map.mosaic.tile_px}, {"max_zoom", map.mosaic.max_zoom}}},
                              {"extractor", ToParameters(info.extractor)}};
  json["parents"] = nlohmann::json::array();
  for (const MapParent& parent : info.parents) {
    json["parents"].push_back({{"relation", parent.relation}, {"id", parent.id}, {"version", parent.content_version}});
  }
  json["lattices"] = LatticesJson(info.lattices);
  json["layers"] = nlohmann::json::array();
  for (const MapFileLayer& layer : info.layers) {
    json["layers"].push_back(
        {{"name", layer.name}, {"version", layer.version}, {"required", layer.required}, {"known", layer.known}});
  }
  json["surveys"] = Embedded(info.surveys_json);
  json["report"] = Embedded(info.report_json);
  json["scale"] = json["report"].is_object() ? json["report"].value("scale", nlohmann::json()) : nlohmann::json();
  return json;
}

void PrintText(const FloorMap& map, std::size_t frames, std::uintmax_t bytes) {
  const MapInfo& info = map.info;
  std::printf("map          %s\nid           %s\nversion      %s\n", info.name.c_str(), info.id.c_str(),
              info.content_version.c_str());
  std::printf("built        %s by floorloc %s, format %d\n", info.created.c_str(), info.builder_version.c_str(),
              info.format_version);
  for (const MapParent& parent : info.parents) {
    std::printf("%-12s %s\n", parent.relation.c_str(), parent.content_version.c_str());
  }
  std::printf("floor        %.2f m2, x %.2f to %.2f m, y %.2f to %.2f m\n", info.area_m2, info.extent.x_min,
              info.extent.x_max, info.extent.y_min, info.extent.y_max);
  std::printf("frames       %zu\n", frames);
  std::printf("keypoints    %zu (%.0f per m2), %s, %d %s each\n", map.keypoints.size(),
              static_cast<double>(map.keypoints.size()) / std::max(info.area_m2, 1e-9), ToString(info.extractor.type),
              map.keypoints.descriptors.cols, map.keypoints.descriptors.depth() == CV_8U ? "bytes" : "numbers");
  std::printf("mosaic       %.2f mm per pixel, %d levels of %d px tiles\n", 1e3 * map.mosaic.resolution_m,
              map.mosaic.max_zoom + 1, map.mosaic.tile_px);
  for (const MapLattice& lattice : info.lattices) {
    std::printf("lattice      %s\n", LatticeSentence(lattice).c_str());
  }
  for (const MapFileLayer& layer : info.layers) {
    if (!layer.known) {
      std::printf("layer        %s, version %d: not known to this version of floorloc\n", layer.name.c_str(),
                  layer.version);
    }
  }
  std::printf("file         %.1f MB\n", static_cast<double>(bytes) / 1e6);
}

void Run(const Arguments& a) {
  if (IsBag(a.map)) {
    const BagSummary bag = SummarizeBag(a.map);
    PrintBag(bag, PlanSurvey(bag, a.choice), a.json);
    return;
  }
  const MapDatabase database(a.map);
  const FloorMap map = database.ReadMap();
  const std::size_t frames = database.ReadFrames().size();
  if (a.json) {
    std::cout << ToJson(map, frames).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
  } else {
    PrintText(map, frames, std::filesystem::file_size(a.map));
  }
}

}  // namespace

void AddInfoCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("info", "Prints what a map or a bag contains");
  const auto a = std::make_shared<Arguments>();
  command->add_option("map", a->map, "Map file, or bag: .mcap, .db3 or .bag file, or their folder")->required();
  command->add_flag("--json", a->json, "Machine-readable");
  AddCalibrationOptions(command, nullptr, &a->choice);
  AddTopicOptions(command, nullptr, &a->choice);
  command->callback([a] { Run(*a); });
}

}  // namespace floorloc
