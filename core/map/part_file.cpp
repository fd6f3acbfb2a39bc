// SPDX-License-Identifier: Apache-2.0
#include "core/map/part_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

#include "core/map/map_error.h"

namespace floorloc {
namespace {

bool IsSameFile(int descriptor, const std::filesystem::path& path) {
  struct stat opened {};
  struct stat named {};
  return fstat(descriptor, &opened) == 0 && stat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
         opened.st_dev == named.st_dev;
}

void SyncPath(const std::filesystem::path& path) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = descriptor >= 0 && fsync(descriptor) == 0;
  if (descriptor >= 0) {
    close(descriptor);
  }
  if (!synced) {
    throw MapError(path.string() + " cannot be flushed to the disk; check the disk and the free space on it");
  }
}

}  // namespace

PartFile::PartFile(std::filesystem::path path) : path_(std::move(path)) {
  while (!Lock()) {
    // Its owner renamed or removed the file after we opened and before we locked it: retry with a new file.
  }
  std::error_code ignored;
  std::filesystem::remove(path_.string() + "-journal", ignored);
  std::filesystem::resize_file(path_, 0, ignored);
}

PartFile::~PartFile() {
  if (!moved_) {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
    std::filesystem::remove(path_.string() + "-journal", ignored);
  }
  close(descriptor_);
}

bool PartFile::Lock() {
  const int descriptor = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    throw MapError(path_.string() + " cannot be opened; check the path and its permissions");
  }
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    close(descriptor);
    throw MapError(path_.string() + " is being written by another build; wait for it or choose another name");
  }
  if (!IsSameFile(descriptor, path_)) {
    close(descriptor);
    return false;
  }
  descriptor_ = descriptor;
  return true;
}

void PartFile::MoveTo(const std::filesystem::path& file) {
  SyncPath(path_);
  if (std::rename(path_.c_str(), file.c_str()) != 0) {
    throw MapError(file.string() + " cannot be replaced; check the folder's permissions");
  }
  moved_ = true;
  SyncPath(file.has_parent_path() ? file.parent_path() : std::filesystem::path("."));
}

}  // namespace floorloc
