// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <iostream>
#include <stdexcept>

#include "server/daemon/daemon.h"

int main(int argc, char** argv) {
  floorloc::DaemonOptions options;
  CLI::App app("Localizes camera images of the floor over HTTP.", "floorloc-server");
  app.set_version_flag("--version", FLOORLOC_VERSION);
  app.add_option("--maps", options.maps_folder, "Folder with the maps, NAME.floormap")->required();
  app.add_option("--listen", options.listen, "Address and port; port 0 takes any free one")->capture_default_str();
  app.add_option("--config", options.config_file, "Configuration, a JSON file");
  app.add_flag("--check", options.check,
               "Try what a start needs (configuration, tokens, address, every byte of the maps), print it, and exit");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    return floorloc::RunDaemon(options);
  } catch (const std::invalid_argument& error) {
    std::cerr << "floorloc-server: " << error.what() << '\n';
    return 2;  // an option, or one that needs another one
  } catch (const std::exception& error) {
    std::cerr << "floorloc-server: " << error.what() << '\n';
    return 1;
  }
}
