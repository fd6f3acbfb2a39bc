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

/// Journal of a build's intermediate results, kept beside its output so that a killed build can be resumed. An
/// append-only file of checksummed records, synced every few seconds. A key is the SHA-256 (hex) of everything its
/// result depends on, so results of other input are never found. The journal is only an optimisation: any problem with
/// it (damage, full disk, lock held by another build) gives a warning, and the work is repeated. Thread-safe.
class BuildJournal {
 public:
  /// resume: use existing records; else the file starts empty. warnings: may be nullptr.
  BuildJournal(std::filesystem::path file, bool resume, std::ostream* warnings);
  /// Flushes and keeps the file for a later resume; removes it if no record was written yet.
  ~BuildJournal();
  BuildJournal(const BuildJournal&) = delete;
  BuildJournal& operator=(const BuildJournal&) = delete;

  /// The result stored under the key when the file was opened; empty if none.
  std::optional<std::vector<std::uint8_t>> Get(const std::string& key);
  void Put(const std::string& key, const std::vector<std::uint8_t>& piece);
  /// Writes and syncs pending records.
  void Flush();
  /// Deletes the file after a successful build.
  void Remove();
  /// Path of a map file's journal.
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
  int descriptor_ = -1;                                    // -1: journal disabled
  std::int64_t end_ = 0;                                   // end of the last complete record
  std::unordered_map<std::string, RecordLocation> index_;  // constant after construction
  std::mutex file_mutex_;     // for descriptor_ and end_; locked before pending_mutex_ or without it
  std::mutex pending_mutex_;  // for pending_ and written_
  std::vector<std::uint8_t> pending_;
  Clock::time_point written_ = Clock::now();
};

}  // namespace floorloc
