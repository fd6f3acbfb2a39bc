// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "server/store/version_files.h"

namespace floorloc {

/// Lets so many uploads in at a time. Thread-safe; outlives the streams.
class UploadGate {
 public:
  /// max_bytes: of one upload.
  UploadGate(std::uint64_t max_bytes, int max_uploads) : max_bytes_(max_bytes), max_uploads_(max_uploads) {}

  /// Where the bytes of an upload go: an IncomingFile in this folder. announced_bytes: 0: unknown. Throws Problem: 413
  /// map_too_large, 503 upload_busy, 507 disk_full.
  BodyStream Open(const std::filesystem::path& folder, std::uint64_t announced_bytes);

 private:
  const std::uint64_t max_bytes_;
  const int max_uploads_;
  std::atomic<int> uploads_{0};
};

}  // namespace floorloc
