// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/map/map_error.h"

namespace floorloc {

/// An SQLite connection. Throws MapErrors that name the file. Not thread-safe.
class SqliteConnection {
 public:
  enum class Mode { kReadOnly, kCreate };
  SqliteConnection(const std::filesystem::path& file, Mode mode);

  void Execute(const std::string& sql) const;
  /// Throws the latest error of the connection as a MapError that says what to do.
  [[noreturn]] void Fail() const;
  sqlite3* get() const { return handle_.get(); }
  const std::filesystem::path& file() const { return file_; }

 private:
  struct Close {
    void operator()(sqlite3* handle) const { sqlite3_close(handle); }
  };
  std::filesystem::path file_;
  std::unique_ptr<sqlite3, Close> handle_;
};

using Blob = std::vector<std::uint8_t>;

/// A prepared statement: bind in order, then step.
class SqliteStatement {
 public:
  SqliteStatement(const SqliteConnection& connection, const std::string& sql);

  SqliteStatement& Bind(std::int64_t value);
  SqliteStatement& Bind(int value) { return Bind(static_cast<std::int64_t>(value)); }
  SqliteStatement& Bind(double value);
  SqliteStatement& Bind(const std::string& value);
  SqliteStatement& Bind(std::span<const std::uint8_t> blob);
  SqliteStatement& BindNull();

  /// True while there is a row.
  bool Step();
  /// Runs a statement without rows, and makes it ready to be bound again.
  void Run();
  /// Resets the statement and clears its bindings.
  void Reset();

  std::int64_t Integer(int column) const { return sqlite3_column_int64(handle_.get(), column); }
  double Real(int column) const { return sqlite3_column_double(handle_.get(), column); }
  std::string Text(int column) const;
  Blob Bytes(int column) const;
  int columns() const { return sqlite3_column_count(handle_.get()); }
  /// Actual type of the value (SQLITE_INTEGER, ...), which may differ from the declared one.
  int Type(int column) const { return sqlite3_column_type(handle_.get(), column); }
  bool IsNull(int column) const { return Type(column) == SQLITE_NULL; }

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* handle) const { sqlite3_finalize(handle); }
  };
  const SqliteConnection& connection_;
  std::unique_ptr<sqlite3_stmt, Finalize> handle_;
  int bound_ = 0;
};

/// Begins in the constructor; rolled back in the destructor unless committed.
class SqliteTransaction {
 public:
  explicit SqliteTransaction(const SqliteConnection& connection);
  ~SqliteTransaction();
  SqliteTransaction(const SqliteTransaction&) = delete;
  SqliteTransaction& operator=(const SqliteTransaction&) = delete;
  void Commit();

 private:
  const SqliteConnection& connection_;
  bool open_ = true;
};

}  // namespace floorloc
