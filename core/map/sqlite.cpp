// SPDX-License-Identifier: Apache-2.0
#include "core/map/sqlite.h"

namespace floorloc {
namespace {

std::string ErrorHint(int code) {
  switch (code & 0xFF) {
    case SQLITE_FULL:
      return "the disk is full; free some space and run again";
    case SQLITE_NOTADB:
      return "is not a floorloc map; give a .floormap file that floorloc-mapbuilder wrote";
    case SQLITE_CORRUPT:
      return "is damaged; restore it from a copy or build it again";
    case SQLITE_CANTOPEN:
      return "cannot be opened; check the path and its permissions";
    case SQLITE_READONLY:
    case SQLITE_PERM:
      return "cannot be written; check its permissions";
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return "is being written by another process; wait for it or choose another name";
    case SQLITE_IOERR:
      return "cannot be read or written; check the disk and the free space on it";
    default:
      return "is damaged or not a floorloc map; restore it from a copy or build it again";
  }
}

// kDamaged for errors of the file itself, not of the disk, the permissions or another process.
MapError::Kind KindOf(int code) {
  switch (code & 0xFF) {
    case SQLITE_NOTADB:
    case SQLITE_CORRUPT:
    case SQLITE_ERROR:  // a table or column is missing
    case SQLITE_MISMATCH:
    case SQLITE_TOOBIG:
      return MapError::Kind::kDamaged;
    default:
      return MapError::Kind::kOther;
  }
}

}  // namespace

SqliteConnection::SqliteConnection(const std::filesystem::path& file, Mode mode) : file_(file) {
  const int flags = mode == Mode::kReadOnly ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(file.c_str(), &handle, flags | SQLITE_OPEN_NOMUTEX, nullptr);
  handle_.reset(handle);
  if (code != SQLITE_OK) {
    throw MapError(file.string() + " " + ErrorHint(code), KindOf(code));
  }
  sqlite3_extended_result_codes(handle, 1);
}

void SqliteConnection::Fail() const {
  const int code = sqlite3_errcode(get());
  throw MapError(file_.string() + " " + ErrorHint(code) + " (" + sqlite3_errmsg(get()) + ")", KindOf(code));
}

void SqliteConnection::Execute(const std::string& sql) const {
  if (sqlite3_exec(get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) {
    Fail();
  }
}

SqliteStatement::SqliteStatement(const SqliteConnection& connection, const std::string& sql) : connection_(connection) {
  sqlite3_stmt* handle = nullptr;
  if (sqlite3_prepare_v2(connection.get(), sql.c_str(), -1, &handle, nullptr) != SQLITE_OK) {
    connection.Fail();
  }
  handle_.reset(handle);
}

SqliteStatement& SqliteStatement::Bind(std::int64_t value) {
  if (sqlite3_bind_int64(handle_.get(), ++bound_, value) != SQLITE_OK) {
    connection_.Fail();
  }
  return *this;
}

SqliteStatement& SqliteStatement::Bind(double value) {
  if (sqlite3_bind_double(handle_.get(), ++bound_, value) != SQLITE_OK) {
    connection_.Fail();
  }
  return *this;
}

SqliteStatement& SqliteStatement::Bind(const std::string& value) {
  if (sqlite3_bind_text64(handle_.get(), ++bound_, value.data(), value.size(), SQLITE_TRANSIENT, SQLITE_UTF8) !=
      SQLITE_OK) {
    connection_.Fail();
  }
  return *this;
}

SqliteStatement& SqliteStatement::Bind(std::span<const std::uint8_t> blob) {
  static const std::uint8_t kEmpty = 0;  // a null pointer would bind NULL
  const std::uint8_t* data = blob.empty() ? &kEmpty : blob.data();
  if (sqlite3_bind_blob64(handle_.get(), ++bound_, data, blob.size(), SQLITE_TRANSIENT) != SQLITE_OK) {
    connection_.Fail();
  }
  return *this;
}

SqliteStatement& SqliteStatement::BindNull() {
  if (sqlite3_bind_null(handle_.get(), ++bound_) != SQLITE_OK) {
    connection_.Fail();
  }
  return *this;
}

bool SqliteStatement::Step() {
  const int code = sqlite3_step(handle_.get());
  if (code != SQLITE_ROW && code != SQLITE_DONE) {
    connection_.Fail();
  }
  return code == SQLITE_ROW;
}

void SqliteStatement::Run() {
  Step();
  Reset();
}

void SqliteStatement::Reset() {
  sqlite3_reset(handle_.get());
  sqlite3_clear_bindings(handle_.get());
  bound_ = 0;
}

std::string SqliteStatement::Text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(handle_.get(), column));
  return text == nullptr ? std::string()
                         : std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(handle_.get(), column)));
}

Blob SqliteStatement::Bytes(int column) const {
  const auto* bytes = static_cast<const std::uint8_t*>(sqlite3_column_blob(handle_.get(), column));
  return bytes == nullptr ? Blob() : Blob(bytes, bytes + sqlite3_column_bytes(handle_.get(), column));
}

SqliteTransaction::SqliteTransaction(const SqliteConnection& connection) : connection_(connection) {
  connection.Execute("BEGIN");
}

SqliteTransaction::~SqliteTransaction() {
  if (open_) {
    sqlite3_exec(connection_.get(), "ROLLBACK", nullptr, nullptr, nullptr);
  }
}

void SqliteTransaction::Commit() {
  connection_.Execute("COMMIT");
  open_ = false;
}

}  // namespace floorloc
