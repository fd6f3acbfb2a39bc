// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "mapbuilder/cli/command.h"
#include "mapbuilder/finished_map/map_diff.h"

namespace floorloc {
namespace {

struct Arguments {
  std::filesystem::path before, after;
  bool json = false;
};

nlohmann::ordered_json ToJson(const MapDiff& diff) {
  const Pose2& pose = diff.moves.farthest_pose;
  nlohmann::ordered_json json{
      {"relation", diff.relation},
      {"area_m2",
       {{"before", diff.before_m2}, {"after", diff.after_m2}, {"gained", diff.gained_m2}, {"lost", diff.lost_m2}}},
      {"frames", {{"kept", diff.frames_kept}, {"removed", diff.frames_removed}, {"added", diff.frames_added}}},
      {"moves",
       {{"rms_m", diff.moves.rms_m},
        {"max_m", diff.moves.max_m},
        {"max_rad", diff.moves.max_rad},
        {"farthest", diff.moves.farthest},
        {"x", pose.x()},
        {"y", pose.y()}}},
      {"keypoints", nullptr},
      {"parameters", nlohmann::json::array()}};
  if (diff.keypoints) {
    json["keypoints"] = {
        {"kept", diff.keypoints->kept}, {"gone", diff.keypoints->gone}, {"added", diff.keypoints->added}};
  }
  for (const Difference& d : diff.parameters) {
    json["parameters"].push_back({{"name", d.name}, {"before", d.before}, {"after", d.after}});
  }
  return json;
}

void PrintText(const MapDiff& diff) {
  const bool about_the_first = diff.relation == "extends" || diff.relation == "merges";
  std::printf("relation     %s%s\n", diff.relation.c_str(), about_the_first ? " the first" : "");
  std::printf("floor        %.2f m2, was %.2f: %.2f gained, %.2f lost\n", diff.after_m2, diff.before_m2, diff.gained_m2,
              diff.lost_m2);
  std::printf("frames       %d kept, %d added, %d removed\n", diff.frames_kept, diff.frames_added, diff.frames_removed);
  if (diff.frames_kept > 0) {
    std::printf("moved        %.2f mm RMS, up to %.2f mm and %.3f degrees", 1e3 * diff.moves.rms_m,
                1e3 * diff.moves.max_m, diff.moves.max_rad * 180.0 / std::numbers::pi);
    std::printf(diff.moves.max_m > 0.0 ? " (%s at x %.2f, y %.2f)\n" : "\n", diff.moves.farthest.c_str(),
                diff.moves.farthest_pose.x(), diff.moves.farthest_pose.y());
  }
  if (diff.keypoints) {
    std::printf("keypoints    %d kept, %d added, %d gone\n", diff.keypoints->kept, diff.keypoints->added,
                diff.keypoints->gone);
  } else {
    std::printf("keypoints    of another extractor: not to be compared\n");
  }
  for (const Difference& d : diff.parameters) {
    std::printf("%s: %s, was %s\n", d.name.c_str(), d.after.c_str(), d.before.c_str());
  }
}

void Run(const Arguments& a) {
  const MapDiff diff = CompareMaps(MapDatabase(a.before), MapDatabase(a.after));
  if (a.json) {
    std::cout << ToJson(diff).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
  } else {
    PrintText(diff);
  }
}

}  // namespace

void AddDiffCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("diff", "Prints what changed from one map to another");
  const auto a = std::make_shared<Arguments>();
  command->add_option("before", a->before, "Map file")->required();
  command->add_option("after", a->after, "Map file")->required();
  command->add_flag("--json", a->json, "Machine-readable");
  command->callback([a] { Run(*a); });
}

}  // namespace floorloc
