// SPDX-License-Identifier: Apache-2.0
#include "core/io/file_descriptor.h"

#include <unistd.h>

#include <utility>

namespace floorloc {

FileDescriptor& FileDescriptor::operator=(FileDescriptor&& other) noexcept {
  if (this != &other) {
    Reset();
    fd_ = other.Release();
  }
  return *this;
}

int FileDescriptor::Release() { return std::exchange(fd_, -1); }

void FileDescriptor::Reset() {
  if (fd_ >= 0) {
    ::close(fd_);
  }
  fd_ = -1;
}

}  // namespace floorloc
