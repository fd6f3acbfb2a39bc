// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/map_commands.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "mapbuilder/cli/command.h"
#include "server/api/app.h"
#include "server/api/camera_json.h"
#include "tests/fuzz/refusal.h"
#include "tests/fuzz/small_map.h"

namespace floorloc {
namespace {

// MAP, WHOLE, SURVEY and OUT are the files.
constexpr const char* kCommandLines[] = {
    "verify MAP",
    "info MAP",
    "info MAP --json",
    "diff WHOLE MAP",
    "diff MAP WHOLE --json",
    "report MAP --out OUT/report",
    "export MAP --mosaic OUT/mosaic.png --worldfile",
    "export MAP --geotiff OUT/mosaic.tif --resolution 0.01",
    "export MAP --tiles OUT/tiles",
    "export MAP --nav2 OUT/nav2.yaml",
    "export MAP --poses OUT/poses.tum --g2o OUT/graph.g2o --camera OUT/camera",
    "localize --map MAP --frames SURVEY --out OUT/fixes.tum --threads 1",
    "localize --map MAP --frames SURVEY --out OUT/fused.tum --fuse",
    "merge MAP WHOLE --out OUT/merged.floormap --threads 1",
    "merge WHOLE MAP --out OUT/merged.floormap --threads 1 --same-frame",
    "build --extend MAP --survey SURVEY --out OUT/extended.floormap --threads 1",
};

void RunCommandLine(const std::string& line, const std::filesystem::path& map, const MapCommandFiles& files) {
  std::vector<std::string> words;
  std::istringstream in(line);
  for (std::string word; in >> word;) {
    const bool in_out = word.starts_with("OUT/");
    word = in_out ? (files.out / word.substr(4)).string() : word;
    word = word == "MAP" ? map.string() : word == "WHOLE" ? files.whole_map.string() : word;
    words.push_back(word == "SURVEY" ? files.survey.string() : word);
  }
  CLI::App app("", "floorloc-mapbuilder");
  for (const auto add : {AddBuildCommand, AddDiffCommand, AddExportCommand, AddInfoCommand, AddLocalizeCommand,
                         AddMergeCommand, AddReportCommand, AddVerifyCommand}) {
    add(app);
  }
  std::reverse(words.begin(), words.end());  // CLI11 takes them from the end
  app.parse(words);
}

HttpRequest Request(const std::string& method, const std::string& path) {
  HttpRequest request;
  request.method = method;
  request.path = path;
  return request;
}

// Everything that the server says of a map, and an image that it localizes there.
void Serve(const std::filesystem::path& map) {
  ServerConfig config;
  config.threads = 1;
  App app(config, map.parent_path());
  const std::string name = "/v1/maps/" + map.stem().string();
  for (const char* call : {"", "/report", "/fixes", "/tiles/0/0/0.jpg", "/tiles/1/1/1.jpg"}) {
    app.router().Handle(Request("GET", name + call));
  }
  app.router().Handle(Request("GET", "/v1/maps"));
  std::vector<std::uint8_t> png;
  cv::imencode(".png", SmallImage(0.5, 0.5), png);
  HttpRequest localize = Request("POST", name + "/localize");
  localize.headers["content-type"] = "multipart/form-data; boundary=x";
  const FloorCamera camera = SmallCamera();
  const nlohmann::json fields = {{"camera", FormatCamera(camera.camera)}, {"floor", FormatFloor(camera.floor)}};
  localize.parts = {{"request", "application/json", fields.dump()},
                    {"image", "image/png", std::string(png.begin(), png.end())}};
  app.router().Handle(localize);
}

}  // namespace

std::size_t CountMapCommands() { return std::size(kCommandLines) + 1; }

void RunMapCommand(std::size_t command, const std::filesystem::path& map, const MapCommandFiles& files) {
  if (command < std::size(kCommandLines)) {
    MayRefuse<std::runtime_error>([&] { RunCommandLine(kCommandLines[command], map, files); });
  } else {
    Serve(map);
  }
}

}  // namespace floorloc
