// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace floorloc {

/// Finished pieces of a build, kept beside its output so that a killed build need not do them again. An append-only
/// file of checksummed records, synced every few seconds. A key is the SHA-256 (hex) of everything its piece depends
/// on, so pieces of other input are simply never asked for. The journal only saves time: whatever is wrong with it
/// (damage, a full disk, another build that holds it) is a warning and the work is done again. Thread-safe.
class BuildJournal {
 public:
  /// resume: what the file holds may be used; else it starts empty. warnings: may be nullptr.
  BuildJournal(std::filesystem::path file, bool resume, std::ostream* warnings);
  /// Leaves the file for the build that resumes, unless there was too little work yet to be worth it.
  ~BuildJournal();
  BuildJournal(const BuildJournal&) = delete;
  BuildJournal& operator=(const BuildJournal&) = delete;

  /// A piece that the file held when it was opened.
  std::optional<std::vector<std::uint8_t>> Get(const std::string& key);
  void Put(const std::string& key, const std::vector<std::uint8_t>& piece);
  /// Writes what is pending and syncs it.
  void Flush();
  /// The build is done: the file is not needed any more.
  void Remove();
  /// The journal of a map file.
  static std::filesystem::path FileFor(const std::filesystem::path& map) { return map.string() + ".journal"; }

 private:
  struct RecordLocation {
    std::int64_t offset = 0;
    std::int64_t size = 0;
    std::int64_t checksum = 0;
  };
  using Clock = std::chrono::steady_clock;

  bool Open();
  void ReadIndex();
  void WriteOut(const std::vector<std::uint8_t>& bytes);
  void CloseOrRemove();
  void Close();
  void Warn(const std::string& sentence);

  std::filesystem::path file_;
  std::ostream* warnings_;
  int descriptor_ = -1;                                    // -1: no journal is kept
  std::int64_t end_ = 0;                                   // of the last whole record
  std::unordered_map<std::string, RecordLocation> index_;  // constant after construction
  std::mutex file_mutex_;     // of descriptor_ and end_; locked before pending_mutex_ or without it
  std::mutex pending_mutex_;  // of the rest
  std::vector<std::uint8_t> pending_;
  Clock::time_point written_ = Clock::now();
};

}  // namespace floorloc
