// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace floorloc {

/// A folder that is filled under another name and gets its own when it is complete; until then nothing of it stays.
class PendingFolder {
 public:
  /// Throws InputError when there is something at `target` already, an empty folder excepted.
  explicit PendingFolder(const std::filesystem::path& target);
  ~PendingFolder();
  PendingFolder(const PendingFolder&) = delete;
  PendingFolder& operator=(const PendingFolder&) = delete;

  const std::filesystem::path& path() const { return pending_; }

  /// Throws InputError.
  void Complete();

 private:
  std::filesystem::path target_;
  std::filesystem::path pending_;
};

}  // namespace floorloc
