// SPDX-License-Identifier: Apache-2.0
#include "server/store/file_identity.h"

#include <fcntl.h>
#include <sys/stat.h>

namespace floorloc {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

std::optional<FileIdentity> ToIdentity(const struct stat& status) {
  if (!S_ISREG(status.st_mode)) {
    return std::nullopt;
  }
  return FileIdentity{status.st_ino, status.st_size,
                      kNanosecondsPerSecond * status.st_mtim.tv_sec + status.st_mtim.tv_nsec};
}

}  // namespace

std::optional<FileIdentity> FileIdentity::Of(const std::filesystem::path& file) {
  struct stat status {};
  return ::stat(file.c_str(), &status) == 0 ? ToIdentity(status) : std::nullopt;
}

std::optional<FileIdentity> FileIdentity::OfDescriptor(int descriptor) {
  struct stat status {};
  return ::fstat(descriptor, &status) == 0 ? ToIdentity(status) : std::nullopt;
}

std::string FileIdentity::ToText() const {
  return std::to_string(inode) + ":" + std::to_string(bytes) + ":" + std::to_string(modified_ns);
}

OpenedFile::OpenedFile(const std::filesystem::path& file)
    : descriptor_(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)),
      identity_(descriptor_ ? FileIdentity::OfDescriptor(descriptor_.get()) : std::nullopt) {}

bool OpenedFile::IsUnchanged() const { return identity_ && FileIdentity::OfDescriptor(descriptor_.get()) == identity_; }

bool OpenedFile::IsStillAt(const std::filesystem::path& file) const {
  return identity_ && FileIdentity::Of(file) == identity_;
}

}  // namespace floorloc
