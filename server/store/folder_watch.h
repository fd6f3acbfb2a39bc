// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <thread>

#include "core/io/file_descriptor.h"

namespace floorloc {

struct FolderWatchOptions {
  /// After the last change, before it is told: programs that copy several files, or one in pieces, are done then.
  std::chrono::duration<double> settle{0.2};
  /// Without changes, so often all the same: network file systems don't tell what other machines write.
  std::chrono::duration<double> interval{10.0};

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Calls a function, in a thread of its own, after files of a folder were written, moved there or removed (inotify).
class FolderWatch {
 public:
  FolderWatch(const std::filesystem::path& folder, const FolderWatchOptions& options, std::function<void()> changed);
  ~FolderWatch();
  FolderWatch(const FolderWatch&) = delete;
  FolderWatch& operator=(const FolderWatch&) = delete;

 private:
  void Run();
  /// False: the end. Returns after a change, or timeout.
  bool Wait(std::chrono::duration<double> timeout, bool* changed) const;

  const FolderWatchOptions options_;
  const std::function<void()> changed_;
  const FileDescriptor inotify_;
  const FileDescriptor stop_;
  std::thread thread_;
};

}  // namespace floorloc
