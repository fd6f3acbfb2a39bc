// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <string>

#include "server/bridge/bridge_config.h"

namespace floorloc {

/// A file of an http or https link, in a folder of its own below TMPDIR, which this object removes.
class DownloadedFile {
 public:
  /// Redirections are not followed: they would lead past DownloadOptions::from. stop: ends it early. Throws
  /// std::runtime_error with one sentence.
  DownloadedFile(const std::string& link, const DownloadOptions& options, const std::atomic<bool>& stop);
  ~DownloadedFile();
  DownloadedFile(const DownloadedFile&) = delete;
  DownloadedFile& operator=(const DownloadedFile&) = delete;

  std::filesystem::path path() const { return folder_ / "map"; }
  const std::string& sha256() const { return sha256_; }  ///< lower-case hexadecimal

 private:
  void Download(const std::string& link, const DownloadOptions& options, const std::atomic<bool>& stop);

  std::filesystem::path folder_;
  std::string sha256_;
};

}  // namespace floorloc
