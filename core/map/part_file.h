// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace floorloc {

/// The unfinished file of one build: empty at first, locked against other builds (also those of other processes) and
/// removed at the end, unless it was renamed to its final name. A leftover of a killed build is overwritten.
class PartFile {
 public:
  /// Throws MapError when another build holds the file or it can't be made.
  explicit PartFile(std::filesystem::path path);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Flushes to the disk and renames, replacing `file`. Throws MapError.
  void MoveTo(const std::filesystem::path& file);

 private:
  bool Lock();

  std::filesystem::path path_;
  int descriptor_ = -1;
  bool moved_ = false;
};

}  // namespace floorloc
