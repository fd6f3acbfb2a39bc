// SPDX-License-Identifier: Apache-2.0
#include "server/store/upload_gate.h"

#include "server/wire/problem.h"

namespace floorloc {

BodyStream UploadGate::Open(const std::filesystem::path& folder, std::uint64_t announced_bytes) {
  if (announced_bytes > max_bytes_) {
    throw MapTooLarge(max_bytes_);
  }
  std::error_code error;
  const auto space = std::filesystem::space(folder.parent_path().parent_path(), error);
  if (!error && space.available < announced_bytes) {
    throw Problem(507, "disk_full", "The disk of the maps folder has no room for this map; delete versions.");
  }
  if (uploads_.fetch_add(1) >= max_uploads_) {
    --uploads_;
    throw Overload("upload_busy", "Other maps are being uploaded; try again when they are done.");
  }
  try {
    auto file = std::make_unique<IncomingFile>(folder, max_bytes_);
    const auto close = [this](BodySink* sink) {
      delete sink;
      --uploads_;
    };
    return {std::shared_ptr<BodySink>(file.release(), close), max_bytes_};
  } catch (...) {
    --uploads_;
    throw;
  }
}

}  // namespace floorloc
