// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <stdexcept>

#include "core/io/file_descriptor.h"
#include "core/map/sqlite.h"

namespace floorloc {

/// The state can't be written here; the maps can be served without.
class StateInUse : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The SQLite file in which a server remembers what outlives it (schema/state.sql). One process writes it at a time.
/// Thread-safe.
class StateFile {
 public:
  enum class Mode { kWrite, kRead };

  /// kWrite: makes it when it is missing. Throws StateInUse when another server writes it or the folder can't be
  /// written, InputError that says what to do when it is damaged or of another version of this program.
  StateFile(const std::filesystem::path& file, Mode mode);

  /// Commits what the function writes, or nothing when it throws. Throws Problem 500 state_unavailable when the file
  /// can't be written.
  enum class Durability {
    kProcess,  ///< outlives the process, whatever ends it
    kPower,    ///< and a power cut: waits for the disk
  };
  void Write(Durability durability, const std::function<void(const SqliteConnection&)>& change);
  /// Throws MapError when the file can't be read.
  void Read(const std::function<void(const SqliteConnection&)>& query) const;

 private:
  void Lock(const std::filesystem::path& file);
  void Open(const std::filesystem::path& file, Mode mode);

  FileDescriptor lock_;  // closed after connection_
  mutable std::mutex mutex_;
  std::unique_ptr<SqliteConnection> connection_;  // guarded by mutex_
};

}  // namespace floorloc
