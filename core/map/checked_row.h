// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/pose2.h"
#include "core/map/sqlite.h"

namespace floorloc {

/// Throws a MapError (damaged) that names the file, what is wrong with it and what to do.
[[noreturn]] void ThrowDamaged(const SqliteConnection& connection, const std::string& what);

/// A row of a map table whose values are checked as they are read: SQLite allows any type in any column. Throws a
/// MapError that names row and column.
class CheckedRow {
 public:
  /// name: of the row, for messages, e.g. "frame 12". Refers to connection and row, which must outlive it.
  CheckedRow(const SqliteConnection& connection, const SqliteStatement& row, std::string name)
      : connection_(connection), row_(row), name_(std::move(name)) {}

  std::int64_t Long(int column, const char* what) const;
  int Integer(int column, const char* what, std::int64_t low, std::int64_t high) const;
  /// A finite number, low <= number <= high.
  double Real(int column, const char* what, double low, double high) const;
  /// A coordinate in the map frame, metres, at most kMaxMapCoordinateM in magnitude.
  double Coordinate(int column, const char* what) const;
  /// x, y and yaw in successive columns.
  Pose2 Pose(int first_column, const char* what) const;
  std::string Text(int column, const char* what) const;
  Blob Bytes(int column, const char* what) const;
  /// A blob of `count` finite float64.
  std::vector<double> Doubles(int column, const char* what, std::size_t count) const;

  [[noreturn]] void Refuse(const std::string& why) const;

 private:
  void RequireType(int column, const char* what, int type) const;

  const SqliteConnection& connection_;
  const SqliteStatement& row_;
  std::string name_;
};

}  // namespace floorloc
