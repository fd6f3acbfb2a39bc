// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>

namespace floorloc {

/// Files that the commands need beside the map in question.
struct MapCommandFiles {
  std::filesystem::path whole_map;  ///< that overlaps it
  std::filesystem::path survey;     ///< of floor that it shows
  std::filesystem::path out;        ///< folder for what they write
};

/// How many ways to read a map there are.
std::size_t CountMapCommands();

/// Reads a map in one of these ways: commands of floorloc-mapbuilder, as they stand on a command line, and the server.
/// They may refuse it by a std::runtime_error, whose sentence people get to read; others come through.
void RunMapCommand(std::size_t command, const std::filesystem::path& map, const MapCommandFiles& files);

}  // namespace floorloc
