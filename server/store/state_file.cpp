// SPDX-License-Identifier: Apache-2.0
#include "server/store/state_file.h"

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/file.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "core/io/input_error.h"
#include "schema/embedded.h"
#include "server/wire/problem.h"

namespace floorloc {
namespace {

constexpr std::int64_t kApplicationId = 0x464C5354;  // "FLST"
constexpr int kFormatVersion = 1;

std::int64_t Pragma(const SqliteConnection& connection, const std::string& name) {
  SqliteStatement statement(connection, "PRAGMA " + name);
  return statement.Step() ? statement.Integer(0) : 0;
}

bool IsEmpty(const SqliteConnection& connection) {
  SqliteStatement tables(connection, "SELECT COUNT(*) FROM sqlite_schema");
  return tables.Step() && tables.Integer(0) == 0;
}

void CheckFormat(const SqliteConnection& connection) {
  if (Pragma(connection, "application_id") != kApplicationId) {
    throw InputError(connection.file(), "it is not a state of floorloc-server; move it away");
  }
  if (Pragma(connection, "user_version") != kFormatVersion) {
    throw InputError(connection.file(), "it was written by another version of floorloc-server; use that one");
  }
  SqliteStatement check(connection, "PRAGMA quick_check(1)");
  if (!check.Step() || check.Text(0) != "ok") {
    throw InputError(connection.file(),
                     "it is damaged: restore it from a copy, or move it away to begin without the active versions and "
                     "vehicles that it holds");
  }
}

}  // namespace

StateFile::StateFile(const std::filesystem::path& file, Mode mode) {
  try {
    if (mode == Mode::kWrite) {
      Lock(file);
    }
    Open(file, mode);
  } catch (const MapError& error) {
    throw InputError(file, std::string("it can't be opened, or is damaged: restore it from a copy or move it away (") +
                               error.what() + ")");
  }
}

// SQLite's own locks are per statement.
void StateFile::Lock(const std::filesystem::path& file) {
  const std::string name = file.string() + ".lock";
  lock_ = FileDescriptor(::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
  if (!lock_) {
    throw StateInUse(name + " can't be made (" + std::strerror(errno) + ")");
  }
  if (::flock(lock_.get(), LOCK_EX | LOCK_NB) != 0) {
    throw StateInUse("another floorloc-server uses " + file.string());
  }
}

void StateFile::Open(const std::filesystem::path& file, Mode mode) {
  connection_ = std::make_unique<SqliteConnection>(
      file, mode == Mode::kWrite ? SqliteConnection::Mode::kCreate : SqliteConnection::Mode::kReadOnly);
  connection_->Execute("PRAGMA busy_timeout = 2000");
  if (mode == Mode::kRead || !IsEmpty(*connection_)) {
    CheckFormat(*connection_);
  }
  if (mode == Mode::kWrite) {
    connection_->Execute("PRAGMA journal_mode = WAL");
    SqliteTransaction transaction(*connection_);
    connection_->Execute(std::string(StateSql()));
    transaction.Commit();
  }
}

void StateFile::Write(Durability durability, const std::function<void(const SqliteConnection&)>& change) {
  const std::lock_guard lock(mutex_);
  try {
    connection_->Execute(durability == Durability::kPower ? "PRAGMA synchronous = FULL"
                                                          : "PRAGMA synchronous = NORMAL");
    SqliteTransaction transaction(*connection_);
    change(*connection_);
    transaction.Commit();
  } catch (const MapError& error) {
    spdlog::error("the server's state can't be written: {}", error.what());
    throw Problem(500, "state_unavailable",
                  "The server can't write its state, and its log says why; check the disk and the free space on it.");
  }
}

void StateFile::Read(const std::function<void(const SqliteConnection&)>& query) const {
  const std::lock_guard lock(mutex_);
  query(*connection_);
}

}  // namespace floorloc
