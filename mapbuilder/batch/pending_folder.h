// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace floorloc {

/// A folder that is filled under a temporary name and renamed when complete; removed otherwise.
class PendingFolder {
 public:
  /// Throws InputError when `target` exists and is not an empty folder.
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
