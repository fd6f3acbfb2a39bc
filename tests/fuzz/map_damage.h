// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sqlite3.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tests/fuzz/byte_source.h"

namespace floorloc {

/// Changes rows of a map file as its input says. Bytes changed at random mostly break SQLite's pages, which are checked
/// before anything is read; this is what stands in whole pages.
class MapDamage {
 public:
  explicit MapDamage(const std::filesystem::path& file);

  /// Takes away what the file says of its own columns (NOT NULL, CHECK): one from outside need not say it.
  static void DropConstraints(const std::filesystem::path& file);

  /// Gives the map a lattice, as that of a floor of tiles has.
  static void AddLattice(const std::filesystem::path& file);

  /// One change, named by six bytes: table, column, row, kind and two more. Returns it as SQL, for people.
  std::string Change(ByteSource& source);
  /// Makes the checksums of all rows and the content version right, so that readers go on to what was changed.
  void RenewChecksums();

 private:
  struct Close {
    void operator()(sqlite3* handle) const { sqlite3_close(handle); }
  };
  struct Table {
    std::string name;
    std::vector<std::string> columns;
    std::string key;  ///< the columns that name a row, between commas
  };

  void ReadTables();
  void Run(const std::string& sql) const;

  std::filesystem::path file_;
  std::unique_ptr<sqlite3, Close> handle_;
  std::vector<Table> tables_;
};

}  // namespace floorloc
