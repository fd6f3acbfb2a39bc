// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "core/io/file_descriptor.h"

namespace floorloc {

/// Tells whether a file was replaced or written since it was last looked at.
struct FileIdentity {
  std::uint64_t inode = 0;
  std::int64_t bytes = 0;
  std::int64_t modified_ns = 0;

  /// Empty when there is no regular file of this name.
  static std::optional<FileIdentity> Of(const std::filesystem::path& file);
  static std::optional<FileIdentity> OfDescriptor(int descriptor);
  std::string ToText() const;
  bool operator==(const FileIdentity&) const = default;
};

/// Watches the file that was opened under a name, whatever is under that name later.
class OpenedFile {
 public:
  explicit OpenedFile(const std::filesystem::path& file);

  /// Nobody wrote into it since it was opened. False when it could not be opened.
  bool IsUnchanged() const;
  std::int64_t bytes() const { return identity_ ? identity_->bytes : 0; }
  double modified_s() const { return identity_ ? 1e-9 * static_cast<double>(identity_->modified_ns) : 0.0; }
  /// Is it still the file under this name?
  bool IsStillAt(const std::filesystem::path& file) const;

 private:
  FileDescriptor descriptor_;
  std::optional<FileIdentity> identity_;
};

}  // namespace floorloc
