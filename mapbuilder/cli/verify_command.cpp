// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>
#include <memory>

#include "core/map/map_database.h"
#include "mapbuilder/cli/command.h"

namespace floorloc {

void AddVerifyCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("verify", "Checks every byte of a map against its checksums");
  const auto file = std::make_shared<std::filesystem::path>();
  command->add_option("map", *file, "Map file")->required();
  command->callback([file] {
    const MapDatabase map(*file);
    map.VerifyContent();
    const MapInfo info = map.ReadInfo();
    std::cout << file->string() << ": whole, version " << info.content_version << "\n";
    for (const MapFileLayer& layer : info.layers) {
      if (!layer.known) {
        std::cout << "not checked: the layer '" << layer.name << "', which this version of floorloc does not know\n";
      }
    }
  });
}

}  // namespace floorloc
