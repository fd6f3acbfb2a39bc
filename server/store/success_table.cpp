// SPDX-License-Identifier: Apache-2.0
#include "server/store/success_table.h"

namespace floorloc {

std::map<std::string, MapSuccess> ReadSuccess(const SqliteConnection& connection) {
  std::map<std::string, MapSuccess> maps;
  SqliteStatement map(connection, "SELECT map, version, square_m, since_s, unplaced FROM success WHERE unplaced >= 0");
  while (map.Step()) {
    maps[map.Text(0)] = {map.Text(1), map.Real(2), map.Real(3), map.Integer(4), {}};
  }
  SqliteStatement square(connection,
                         "SELECT map, x, y, found, missed, inliers FROM success_square WHERE found >= 0 AND missed >= "
                         "0 AND inliers >= 0 AND found + missed > 0");
  while (square.Step()) {
    if (const auto known = maps.find(square.Text(0)); known != maps.end()) {
      known->second.squares.push_back({static_cast<int>(square.Integer(1)), static_cast<int>(square.Integer(2)),
                                       square.Integer(3), square.Integer(4), square.Integer(5)});
    }
  }
  return maps;
}

void WriteSuccess(const SqliteConnection& connection, const std::string& map, const MapSuccess& success) {
  SqliteStatement(connection,
                  "DELETE FROM success_square WHERE map = ?1 AND NOT EXISTS "
                  "(SELECT 1 FROM success WHERE map = ?1 AND version = ?2 AND square_m = ?3)")
      .Bind(map)
      .Bind(success.version)
      .Bind(success.square_m)
      .Run();
  SqliteStatement(connection, "INSERT OR REPLACE INTO success VALUES (?,?,?,?,?)")
      .Bind(map)
      .Bind(success.version)
      .Bind(success.square_m)
      .Bind(success.since_s)
      .Bind(success.unplaced)
      .Run();
}

void WriteSuccessSquare(const SqliteConnection& connection, const std::string& map, const SuccessSquare& square) {
  SqliteStatement(connection, "INSERT OR REPLACE INTO success_square VALUES (?,?,?,?,?,?)")
      .Bind(map)
      .Bind(square.x)
      .Bind(square.y)
      .Bind(square.found)
      .Bind(square.missed)
      .Bind(square.inliers)
      .Run();
}

void DeleteSuccess(const SqliteConnection& connection, const std::string& map) {
  SqliteStatement(connection, "DELETE FROM success_square WHERE map = ?").Bind(map).Run();
  SqliteStatement(connection, "DELETE FROM success WHERE map = ?").Bind(map).Run();
}

}  // namespace floorloc
