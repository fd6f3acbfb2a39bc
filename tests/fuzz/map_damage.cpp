// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/map_damage.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <span>

#include "core/map/content_hash.h"
#include "core/map/map_contract.h"

namespace floorloc {
namespace {

using Bytes = std::vector<std::uint8_t>;

// Values that no builder writes where they come to stand.
constexpr std::array kValues = {"NULL",
                                "0",
                                "-1",
                                "1",
                                "65535",
                                "1000000",
                                "2147483647",
                                "-2147483648",
                                "4294967296",
                                "9223372036854775807",
                                "-9223372036854775807 - 1",
                                "0.5",
                                "1e-300",
                                "1e300",
                                "-1e300",
                                "9e999",
                                "-9e999",
                                "''",
                                "CAST(x'F028' AS TEXT)",
                                "x''",
                                "zeroblob(8)",
                                "zeroblob(72)",
                                "zeroblob(100000)",
                                "'sift'",
                                "'equidistant'",
                                "'{}'",
                                "'[1, {}, null, {\"folder\": 5}]'",
                                "'{\"held_out\": [{\"pose\": [1e300, 0, 0]}], \"dropped\": [{}]}'"};

enum class BlobChange { kShorter, kLonger, kFlipped, kDouble, kFloat, kCount };

constexpr std::array kDoubles = {0.0, -1.0, 1e-300, 1e300, -1e300, HUGE_VAL, -HUGE_VAL, double{NAN}};

template <typename T>
void Overwrite(std::size_t index, T value, Bytes* bytes) {
  const std::size_t count = bytes->size() / sizeof(T);
  if (count > 0) {
    std::memcpy(bytes->data() + index % count * sizeof(T), &value, sizeof(T));
  }
}

void Apply(BlobChange change, std::size_t place, std::size_t value, Bytes* bytes) {
  switch (change) {
    case BlobChange::kShorter:
      bytes->resize(bytes->size() - std::min(bytes->size(), place + 1));
      break;
    case BlobChange::kLonger:
      bytes->resize(bytes->size() + place + 1, static_cast<std::uint8_t>(value));
      break;
    case BlobChange::kFlipped:
      if (!bytes->empty()) {
        (*bytes)[place % bytes->size()] ^= static_cast<std::uint8_t>(value);
      }
      break;
    case BlobChange::kDouble:
      Overwrite(place, kDoubles[value % kDoubles.size()], bytes);
      break;
    default:
      Overwrite(place, static_cast<float>(kDoubles[value % kDoubles.size()]), bytes);
  }
}

Bytes BytesOf(sqlite3_value* value) {
  const auto* bytes = static_cast<const std::uint8_t*>(sqlite3_value_blob(value));
  return {bytes, bytes + sqlite3_value_bytes(value)};
}

// changed(blob, BlobChange, place, value)
void Changed(sqlite3_context* context, int, sqlite3_value** values) {
  Bytes bytes = BytesOf(values[0]);
  Apply(static_cast<BlobChange>(sqlite3_value_int(values[1])), static_cast<std::size_t>(sqlite3_value_int(values[2])),
        static_cast<std::size_t>(sqlite3_value_int(values[3])), &bytes);
  if (sqlite3_value_type(values[0]) == SQLITE_TEXT) {
    sqlite3_result_text(context, reinterpret_cast<const char*>(bytes.data()), static_cast<int>(bytes.size()),
                        SQLITE_TRANSIENT);
  } else {
    sqlite3_result_blob(context, bytes.empty() ? "" : static_cast<const void*>(bytes.data()),
                        static_cast<int>(bytes.size()), SQLITE_TRANSIENT);
  }
}

// checksum_of(blob, ...)
void ChecksumOf(sqlite3_context* context, int count, sqlite3_value** values) {
  ContentHash hash;
  for (int i = 0; i < count; ++i) {
    hash.Add(BytesOf(values[i]));
  }
  sqlite3_result_int64(context, hash.Checksum());
}

using Statement = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;

Statement Prepare(sqlite3* handle, const std::string& sql) {
  sqlite3_stmt* statement = nullptr;
  sqlite3_prepare_v2(handle, sql.c_str(), -1, &statement, nullptr);
  return {statement, sqlite3_finalize};
}

std::string Text(const Statement& row, int column) {
  return reinterpret_cast<const char*>(sqlite3_column_text(row.get(), column));
}

}  // namespace

MapDamage::MapDamage(const std::filesystem::path& file) : file_(file) {
  sqlite3* handle = nullptr;
  if (sqlite3_open(file.c_str(), &handle) != SQLITE_OK) {
    std::abort();
  }
  handle_.reset(handle);
  sqlite3_create_function(handle, "changed", 4, SQLITE_UTF8, nullptr, Changed, nullptr, nullptr);
  sqlite3_create_function(handle, "checksum_of", -1, SQLITE_UTF8, nullptr, ChecksumOf, nullptr, nullptr);
  Run("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF; PRAGMA ignore_check_constraints = ON");
  ReadTables();
}

void MapDamage::ReadTables() {
  const Statement name = Prepare(handle_.get(), "SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY name");
  while (sqlite3_step(name.get()) == SQLITE_ROW) {
    Table table{Text(name, 0), {}, ""};
    const Statement column = Prepare(handle_.get(), "SELECT name, pk FROM pragma_table_info('" + table.name + "')");
    while (sqlite3_step(column.get()) == SQLITE_ROW) {
      table.columns.push_back(Text(column, 0));
      if (sqlite3_column_int(column.get(), 1) > 0) {
        table.key += (table.key.empty() ? "" : ", ") + table.columns.back();
      }
    }
    table.key = table.key.empty() ? "rowid" : table.key;
    tables_.push_back(std::move(table));
  }
}

// A change that breaks what is left of the constraints is none.
void MapDamage::Run(const std::string& sql) const {
  sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr);
}

void MapDamage::DropConstraints(const std::filesystem::path& file) {
  MapDamage(file).Run(
      "PRAGMA writable_schema = ON;"
      "UPDATE sqlite_master SET sql = replace(sql, 'NOT NULL', '');"
      "UPDATE sqlite_master SET sql = replace(sql, 'CHECK (one = 1)', '');"
      "UPDATE sqlite_master SET sql = replace(sql, 'CHECK (descriptor_type IN (''binary'', ''float''))', '');"
      "UPDATE sqlite_master SET sql = replace(sql, 'CHECK (relation IN (''extends'', ''merges''))', '');"
      "PRAGMA writable_schema = RESET");
}

void MapDamage::AddLattice(const std::filesystem::path& file) {
  MapDamage map(file);
  map.Run(
      "INSERT INTO floor_lattice SELECT 0, x_min, x_max, y_min, y_max, 1, 0.3, 0, 0, 0.2, 0.1, 0.1, 1e-3, 0.9 FROM map;"
      "INSERT INTO layer VALUES ('floor_lattice', 1, 0, lower(hex(zeroblob(32))))");
  map.RenewChecksums();
}

std::string MapDamage::Change(ByteSource& source) {
  const Table& table = tables_[source.Below(tables_.size())];
  const std::size_t column = source.Below(table.columns.size() + 1);
  const std::size_t row = source.Byte();
  const std::size_t kind = source.Below(kValues.size() + static_cast<std::size_t>(BlobChange::kCount));
  const std::size_t place = source.Byte();
  const std::size_t value = source.Byte();
  // The last row number stands for all.
  const std::string where = row == 255 ? ""
                                       : " WHERE (" + table.key + ") = (SELECT " + table.key + " FROM " + table.name +
                                             " LIMIT 1 OFFSET " + std::to_string(row) + ")";
  if (column == table.columns.size()) {
    Run("DELETE FROM " + table.name + where);
    return "DELETE FROM " + table.name + where + ";";
  }
  const std::string& name = table.columns[column];
  const std::string new_value = kind < kValues.size()
                                    ? kValues[kind]
                                    : "changed(" + name + ", " + std::to_string(kind - kValues.size()) + ", " +
                                          std::to_string(place) + ", " + std::to_string(value) + ")";
  const std::string sql = "UPDATE " + table.name + " SET " + name + " = " + new_value + where + ";";
  Run(sql);
  return sql;
}

void MapDamage::RenewChecksums() {
  Run("UPDATE keypoint_tile SET checksum = checksum_of(position, angle, size, response, observations, distinctiveness, "
      "last_survey, descriptor); UPDATE mosaic_tile SET checksum = checksum_of(jpeg)");
  const SqliteConnection connection(file_, SqliteConnection::Mode::kReadOnly);
  Run("UPDATE map SET content_version = '" + ComputeContentVersion(connection) + "'");
}

}  // namespace floorloc
