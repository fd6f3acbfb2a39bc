// SPDX-License-Identifier: Apache-2.0
#include "core/io/text_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/io/input_error.h"

namespace floorloc {
namespace {

std::string Reason(int error_number) { return std::generic_category().message(error_number); }

// Reads in chunks and ignores the size that the file system reports: pipes have none, and files may grow.
template <typename Bytes>
Bytes ReadWhole(const std::filesystem::path& file, std::uint64_t max_bytes) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) {
    throw InputError(file, "is a folder where a file is needed; name the file");
  }
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    throw InputError(file, "cannot be opened (" + Reason(errno) + "); check the name and the permissions");
  }
  constexpr std::size_t kPiece = std::size_t{1} << 16;
  Bytes content;
  while (in) {
    const std::size_t size = content.size();
    content.resize(size + kPiece);
    in.read(reinterpret_cast<char*>(content.data() + size), static_cast<std::streamsize>(kPiece));
    content.resize(size + static_cast<std::size_t>(in.gcount()));
    if (content.size() > max_bytes) {
      throw InputError(
          file, "is larger than the limit of " + std::to_string(max_bytes) + " bytes; check that it is the right file");
    }
  }
  if (in.bad()) {
    throw InputError(file, "cannot be read to its end; check the disk");
  }
  return content;
}

// A file written under a temporary name; removed unless Commit() succeeds.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::filesystem::path target) : target_(std::move(target)) {
    constexpr int kMaxNames = 100;
    for (int i = 0; i < kMaxNames && descriptor_ < 0; ++i) {
      name_ = target_;
      name_ += ".tmp-" + std::to_string(::getpid()) + "-" + std::to_string(i);
      descriptor_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (descriptor_ < 0 && errno != EEXIST) {
        break;
      }
    }
    if (descriptor_ < 0) {
      Fail();
    }
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (descriptor_ >= 0) {
      ::close(descriptor_);
    }
    if (!committed_) {
      ::unlink(name_.c_str());
    }
  }

  void Write(std::string_view content) {
    while (!content.empty()) {
      const ssize_t written = ::write(descriptor_, content.data(), content.size());
      if (written < 0 && errno != EINTR) {
        Fail();
      }
      content.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(written, 0)));
    }
  }

  void Commit() {
    if (::fsync(descriptor_) != 0) {
      Fail();
    }
    const int result = ::close(descriptor_);
    descriptor_ = -1;
    if (result != 0 || ::rename(name_.c_str(), target_.c_str()) != 0) {
      Fail();
    }
    committed_ = true;
    FlushFolder();
  }

 private:
  [[noreturn]] void Fail() const {
    throw InputError(target_, "cannot be written (" + Reason(errno) +
                                  "); check the folder, its permissions and the "
                                  "free space");
  }

  // The rename is durable once the folder is flushed. File systems that cannot flush a folder return EINVAL.
  void FlushFolder() const {
    const std::filesystem::path parent = target_.parent_path();
    const int folder = ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0) {
      Fail();
    }
    const int result = ::fsync(folder);
    const int error_number = errno;
    ::close(folder);
    if (result != 0 && error_number != EINVAL) {
      errno = error_number;
      Fail();
    }
  }

  std::filesystem::path target_;
  std::filesystem::path name_;
  int descriptor_ = -1;
  bool committed_ = false;
};

}  // namespace

std::string ReadTextFile(const std::filesystem::path& file, std::uint64_t max_bytes) {
  return ReadWhole<std::string>(file, max_bytes);
}

std::vector<std::uint8_t> ReadBinaryFile(const std::filesystem::path& file, std::uint64_t max_bytes) {
  return ReadWhole<std::vector<std::uint8_t>>(file, max_bytes);
}

void CheckWritable(const std::filesystem::path& file) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  if (!std::filesystem::is_directory(folder) || access(folder.c_str(), W_OK | X_OK) != 0 ||
      std::filesystem::is_directory(file)) {
    throw InputError(file, "cannot be written; check the folder and its permissions");
  }
}

void WriteFileAtomically(const std::filesystem::path& file, const std::string& content) {
  TemporaryFile temporary(file);
  temporary.Write(content);
  temporary.Commit();
}

}  // namespace floorloc
