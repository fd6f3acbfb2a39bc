// SPDX-License-Identifier: Apache-2.0
#include "server/store/version_files.h"

#include <fcntl.h>
#include <linux/fs.h>
#include <spdlog/spdlog.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "server/wire/names.h"
#include "server/wire/problem.h"

namespace floorloc {
namespace {

constexpr const char* kIncoming = "incoming-";
constexpr std::size_t kCopyBytes = std::size_t{1} << 20;

[[noreturn]] void FailOn(const std::filesystem::path& file, int error) {
  spdlog::error("{}: {}", file.string(), std::strerror(error));
  if (error == ENOSPC || error == EDQUOT) {
    throw Problem(507, "disk_full", "The disk of the maps folder is full; delete versions, or make room on it.");
  }
  throw Problem(500, "state_unavailable",
                "The server can't write into its maps folder, and its log says why; check the disk and permissions.");
}

void SyncFolder(const std::filesystem::path& folder) {
  const FileDescriptor descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!descriptor || ::fsync(descriptor.get()) != 0) {
    FailOn(folder, errno);
  }
}

std::vector<std::filesystem::path> List(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    paths.push_back(entry.path());
  }
  return paths;
}

}  // namespace

Problem MapTooLarge(std::uint64_t max_bytes) {
  return {413, "map_too_large",
          "The map is larger than " + std::to_string(max_bytes) + " bytes, the limit (limits.max_map_bytes)."};
}

IncomingFile::IncomingFile(const std::filesystem::path& folder, std::uint64_t max_bytes) : max_bytes_(max_bytes) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  std::string name = (folder / kIncoming).string() + "XXXXXX";
  descriptor_ = FileDescriptor(::mkostemp(name.data(), O_CLOEXEC));
  if (!descriptor_) {
    FailOn(folder, errno);
  }
  path_ = name;
}

IncomingFile::~IncomingFile() {
  if (!kept_) {
    ::unlink(path_.c_str());
  }
}

void IncomingFile::Fail(int error) const { FailOn(path_, error); }

void IncomingFile::Write(std::string_view bytes) {
  bytes_ += bytes.size();
  if (bytes_ > max_bytes_) {
    throw MapTooLarge(max_bytes_);
  }
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_.get(), bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) {
      Fail(errno);
    }
    bytes.remove_prefix(written > 0 ? static_cast<std::size_t>(written) : 0);
  }
}

void IncomingFile::CopyFrom(const std::filesystem::path& file) {
  const FileDescriptor source(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (!source) {
    FailOn(file, errno);
  }
  struct stat status {};
  if (::ioctl(descriptor_.get(), FICLONE, source.get()) == 0 && ::fstat(descriptor_.get(), &status) == 0) {
    bytes_ = static_cast<std::uint64_t>(status.st_size);
    Write({});  // too large?
    return;
  }
  const std::unique_ptr<char[]> buffer(new char[kCopyBytes]);
  for (;;) {
    const ssize_t count = ::read(source.get(), buffer.get(), kCopyBytes);
    if (count < 0 && errno != EINTR) {
      FailOn(file, errno);
    }
    if (count == 0) {
      return;
    }
    Write({buffer.get(), count > 0 ? static_cast<std::size_t>(count) : 0});
  }
}

void IncomingFile::MoveTo(const std::filesystem::path& file) {
  if (::fchmod(descriptor_.get(), S_IRUSR | S_IRGRP | S_IROTH) != 0 || ::fsync(descriptor_.get()) != 0 ||
      std::rename(path_.c_str(), file.c_str()) != 0) {
    Fail(errno);
  }
  kept_ = true;
  path_ = file;
  SyncFolder(file.parent_path());
  SyncFolder(file.parent_path().parent_path());
}

std::vector<std::pair<std::string, std::string>> VersionFiles::CleanUp() const {
  std::vector<std::pair<std::string, std::string>> found;
  for (const std::filesystem::path& map : List(root_)) {
    for (const std::filesystem::path& file : List(map)) {
      const std::string name = file.filename().string();
      std::error_code error;
      if (name.starts_with(kIncoming)) {
        std::filesystem::remove(file, error);
      } else if (file.extension() == ".floormap" && IsMapName(map.filename().string())) {
        found.emplace_back(map.filename().string(), file.stem().string());
      }
    }
  }
  return found;
}

void VersionFiles::Remove(const std::string& map, const std::string& version) const {
  const std::filesystem::path file = PathOf(map, version);
  if (::unlink(file.c_str()) != 0 && errno != ENOENT) {
    FailOn(file, errno);
  }
  SyncFolder(FolderOf(map));
  std::error_code ignored;
  std::filesystem::remove(FolderOf(map), ignored);  // when it is empty
}

}  // namespace floorloc
