// SPDX-License-Identifier: Apache-2.0
#include "core/map/checked_row.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/map/map_contract.h"

namespace floorloc {
namespace {

const char* TypeName(int type) {
  switch (type) {
    case SQLITE_INTEGER:
      return "whole number";
    case SQLITE_FLOAT:
      return "number";
    case SQLITE_TEXT:
      return "text";
    case SQLITE_BLOB:
      return "blob";
    default:
      return "nothing";
  }
}

std::string NumberText(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.9g", value);
  return text;
}

}  // namespace

void ThrowDamaged(const SqliteConnection& connection, const std::string& what) {
  throw MapError(connection.file().string() + " is damaged (" + what + "); restore it from a copy or build it again",
                 MapError::Kind::kDamaged);
}

void CheckedRow::Refuse(const std::string& why) const { ThrowDamaged(connection_, name_ + ": " + why); }

void CheckedRow::RequireType(int column, const char* what, int type) const {
  if (row_.Type(column) != type) {
    Refuse(std::string(what) + " holds " + TypeName(row_.Type(column)) + " instead of " + TypeName(type));
  }
}

std::int64_t CheckedRow::Long(int column, const char* what) const {
  RequireType(column, what, SQLITE_INTEGER);
  return row_.Integer(column);
}

int CheckedRow::Integer(int column, const char* what, std::int64_t low, std::int64_t high) const {
  const std::int64_t value = Long(column, what);
  if (value < low || value > high) {
    Refuse(std::string(what) + " is " + std::to_string(value) + ", not within " + std::to_string(low) + " to " +
           std::to_string(high));
  }
  return static_cast<int>(value);
}

double CheckedRow::Real(int column, const char* what, double low, double high) const {
  if (row_.Type(column) != SQLITE_INTEGER) {
    RequireType(column, what, SQLITE_FLOAT);
  }
  const double value = row_.Real(column);
  if (!(value >= low && value <= high) || !std::isfinite(value)) {
    Refuse(std::string(what) + " is " + NumberText(value) + ", not within " + NumberText(low) + " to " +
           NumberText(high));
  }
  return value;
}

double CheckedRow::Coordinate(int column, const char* what) const {
  return Real(column, what, -kMaxMapCoordinateM, kMaxMapCoordinateM);
}

Pose2 CheckedRow::Pose(int first_column, const char* what) const {
  constexpr double kMaxYawRad = 1e3;  // any number of turns at which a double still resolves the angle
  const std::string name(what);
  return {Coordinate(first_column, (name + "x").c_str()), Coordinate(first_column + 1, (name + "y").c_str()),
          Real(first_column + 2, (name + "yaw").c_str(), -kMaxYawRad, kMaxYawRad)};
}

std::string CheckedRow::Text(int column, const char* what) const {
  RequireType(column, what, SQLITE_TEXT);
  return row_.Text(column);
}

Blob CheckedRow::Bytes(int column, const char* what) const {
  RequireType(column, what, SQLITE_BLOB);
  return row_.Bytes(column);
}

std::vector<double> CheckedRow::Doubles(int column, const char* what, std::size_t count) const {
  const Blob blob = Bytes(column, what);
  std::vector<double> values = UnpackDoubles(blob);
  if (blob.size() != count * sizeof(double) ||
      !std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) {
    Refuse(std::string(what) + " does not hold " + std::to_string(count) + " finite numbers");
  }
  return values;
}

}  // namespace floorloc
