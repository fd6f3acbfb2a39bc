// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/io/file_descriptor.h"
#include "server/wire/body_sink.h"
#include "server/wire/problem.h"

namespace floorloc {

/// A map file on its way into the server's keeping, under a name that nobody serves. Removed at the end unless it was
/// kept. Throws Problem: 413 map_too_large, 507 disk_full, 500 state_unavailable.
class IncomingFile : public BodySink {
 public:
  /// In this folder, which is made.
  IncomingFile(const std::filesystem::path& folder, std::uint64_t max_bytes);
  ~IncomingFile() override;
  IncomingFile(const IncomingFile&) = delete;
  IncomingFile& operator=(const IncomingFile&) = delete;

  void Write(std::string_view bytes) override;
  /// Copies a file; where the file system can, without using space.
  void CopyFrom(const std::filesystem::path& file);
  /// Waits for the disk, then moves it to its name in one step, write-protected.
  void MoveTo(const std::filesystem::path& file);

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t bytes() const { return bytes_; }

 private:
  [[noreturn]] void Fail(int error) const;

  std::filesystem::path path_;
  const std::uint64_t max_bytes_;
  std::uint64_t bytes_ = 0;
  FileDescriptor descriptor_;
  bool kept_ = false;
};

Problem MapTooLarge(std::uint64_t max_bytes);

/// Where the versions of maps are kept: FOLDER/floorloc-versions/MAP/VERSION.floormap.
class VersionFiles {
 public:
  explicit VersionFiles(const std::filesystem::path& maps_folder) : root_(maps_folder / "floorloc-versions") {}

  std::filesystem::path FolderOf(const std::string& map) const { return root_ / map; }
  std::filesystem::path PathOf(const std::string& map, const std::string& version) const {
    return FolderOf(map) / (version + ".floormap");
  }
  /// Removes what a killed server left unfinished, and lists the others: map and version.
  std::vector<std::pair<std::string, std::string>> CleanUp() const;
  /// After it, the file is gone also when the power fails. Throws Problem 500 state_unavailable.
  void Remove(const std::string& map, const std::string& version) const;

 private:
  std::filesystem::path root_;
};

}  // namespace floorloc
