// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "server/store/state_file.h"

namespace floorloc {

/// Images in a square of a map's floor, by what became of them.
struct SuccessSquare {
  int x = 0;  ///< of the square's lower left corner, in squares from the map's (0, 0)
  int y = 0;
  std::int64_t found = 0;
  std::int64_t missed = 0;
  std::int64_t inliers = 0;  ///< sum over those that were found
};

/// The same of a whole map.
struct MapSuccess {
  std::string version;        ///< content version that was asked
  double square_m = 0.0;      ///< side of a square
  double since_s = 0.0;       ///< Unix time of the first image
  std::int64_t unplaced = 0;  ///< that were not found, and nobody knows where they were taken
  std::vector<SuccessSquare> squares;
};

// Functions of a StateFile's connection, by name of the map.
/// Without rows that no server wrote.
std::map<std::string, MapSuccess> ReadSuccess(const SqliteConnection& connection);
/// Writes all but the squares. When the version is another one than before, the squares of that are deleted.
void WriteSuccess(const SqliteConnection& connection, const std::string& map, const MapSuccess& success);
void WriteSuccessSquare(const SqliteConnection& connection, const std::string& map, const SuccessSquare& square);
void DeleteSuccess(const SqliteConnection& connection, const std::string& map);

}  // namespace floorloc
