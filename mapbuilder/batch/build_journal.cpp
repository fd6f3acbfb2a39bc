// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/batch/build_journal.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <ostream>
#include <span>
#include <string_view>
#include <utility>

#include "core/map/content_hash.h"

namespace floorloc {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::string_view kHeader = "floorloc journal 1\n";
constexpr std::uint64_t kRecordMark = 0x464C4F434A524E4CU;  // "FLOCJRNL"
constexpr std::size_t kKeyLength = 64;
constexpr auto kWriteInterval = std::chrono::seconds(2);
constexpr std::size_t kMaxPendingBytes = 8U << 20;

// In native byte order: a journal is not portable.
struct RecordHeader {
  std::uint64_t mark = kRecordMark;
  std::int64_t size = 0;
  std::int64_t checksum = 0;
  char key[kKeyLength] = {};
};

std::int64_t Checksum(const std::string& key, const Bytes& piece) {
  ContentHash hash;
  return hash.Add(key).Add(piece).Checksum();
}

void Append(const void* data, std::size_t size, Bytes* bytes) {
  const auto* first = static_cast<const std::uint8_t*>(data);
  bytes->insert(bytes->end(), first, first + size);
}

bool ReadAt(int descriptor, std::int64_t offset, std::span<std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = pread(descriptor, bytes.data(), bytes.size(), offset);
    if (count <= 0) {
      return false;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(count));
    offset += count;
  }
  return true;
}

bool WriteAt(int descriptor, std::int64_t offset, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = pwrite(descriptor, bytes.data(), bytes.size(), offset);
    if (count <= 0) {
      return false;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(count));
    offset += count;
  }
  return true;
}

}  // namespace

BuildJournal::BuildJournal(std::filesystem::path file, bool resume, std::ostream* warnings)
    : file_(std::move(file)), warnings_(warnings) {
  if (!Open()) {
    return;
  }
  if (resume) {
    ReadIndex();
  }
  const auto* header = reinterpret_cast<const std::uint8_t*>(kHeader.data());
  const bool fresh = end_ == 0;
  if (fresh) {
    end_ = static_cast<std::int64_t>(kHeader.size());
  }
  if (ftruncate(descriptor_, fresh ? 0 : end_) != 0 ||
      (fresh && !WriteAt(descriptor_, 0, std::span(header, kHeader.size())))) {
    Warn("cannot be written; this build could not be resumed");
    Close();
  }
}

BuildJournal::~BuildJournal() {
  if (end_ > static_cast<std::int64_t>(kHeader.size())) {
    Flush();
  }
  CloseOrRemove();
}

// Takes a lock, so that two builds never write one journal.
bool BuildJournal::Open() {
  while (true) {
    descriptor_ = open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor_ < 0 || flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      Warn(descriptor_ < 0 ? "cannot be opened; this build could not be resumed"
                           : "is in use by another build; this build could not be resumed");
      Close();
      return false;
    }
    struct stat opened {};
    struct stat named {};
    if (fstat(descriptor_, &opened) == 0 && stat(file_.c_str(), &named) == 0 && opened.st_ino == named.st_ino) {
      return true;
    }
    Close();  // removed by its owner between our open() and flock()
  }
}

void BuildJournal::ReadIndex() {
  struct stat status {};
  Bytes header(kHeader.size());
  if (fstat(descriptor_, &status) != 0 || status.st_size == 0) {
    return;
  }
  if (!ReadAt(descriptor_, 0, header) || std::memcmp(header.data(), kHeader.data(), header.size()) != 0) {
    Warn("is damaged or not a journal; all work is repeated");
    return;
  }
  end_ = static_cast<std::int64_t>(header.size());
  const auto record_bytes = static_cast<std::int64_t>(sizeof(RecordHeader));
  while (end_ + record_bytes <= status.st_size) {
    RecordHeader record;
    const std::span bytes(reinterpret_cast<std::uint8_t*>(&record), sizeof(record));
    if (!ReadAt(descriptor_, end_, bytes) || record.mark != kRecordMark || record.size < 0) {
      Warn("is damaged; part of the work is repeated");
      return;
    }
    if (record.size > status.st_size - end_ - record_bytes) {
      return;  // the build was killed while writing this record
    }
    index_[std::string(record.key, kKeyLength)] = {end_ + record_bytes, record.size, record.checksum};
    end_ += record_bytes + record.size;
  }
}

std::optional<Bytes> BuildJournal::Get(const std::string& key) {
  const auto found = index_.find(key);
  if (found == index_.end()) {
    return std::nullopt;
  }
  Bytes piece(static_cast<std::size_t>(found->second.size));
  {
    const std::lock_guard lock(file_mutex_);
    if (descriptor_ < 0 || !ReadAt(descriptor_, found->second.offset, piece)) {
      return std::nullopt;
    }
  }
  if (Checksum(key, piece) != found->second.checksum) {
    Warn("is damaged; part of the work is repeated");
    return std::nullopt;
  }
  return piece;
}

void BuildJournal::Put(const std::string& key, const Bytes& piece) {
  RecordHeader record;
  record.size = static_cast<std::int64_t>(piece.size());
  record.checksum = Checksum(key, piece);
  std::memcpy(record.key, key.data(), std::min(key.size(), kKeyLength));
  {
    const std::lock_guard lock(pending_mutex_);
    Append(&record, sizeof(record), &pending_);
    Append(piece.data(), piece.size(), &pending_);
    if (pending_.size() < kMaxPendingBytes && Clock::now() - written_ < kWriteInterval) {
      return;
    }
    written_ = Clock::now();
  }
  Flush();
}

void BuildJournal::Flush() {
  const std::lock_guard file_lock(file_mutex_);
  Bytes bytes;
  {
    const std::lock_guard lock(pending_mutex_);
    bytes.swap(pending_);
  }
  if (descriptor_ >= 0 && !bytes.empty()) {
    WriteOut(bytes);
  }
}

void BuildJournal::WriteOut(const Bytes& bytes) {
  if (WriteAt(descriptor_, end_, bytes) && fdatasync(descriptor_) == 0) {
    end_ += static_cast<std::int64_t>(bytes.size());
    return;
  }
  // Keeps the file: if the disk is too full for the map too, the build can be resumed. A torn record at the end is
  // detected on reading.
  Warn(std::string("cannot be written any more (") + std::strerror(errno) +
       "); the build continues, but could be resumed from here only");
  CloseOrRemove();
}

void BuildJournal::Remove() {
  const std::lock_guard lock(file_mutex_);
  if (descriptor_ >= 0) {
    unlink(file_.c_str());
    Close();
  }
}

// Removes the file if it has no record.
void BuildJournal::CloseOrRemove() {
  if (descriptor_ >= 0 && end_ <= static_cast<std::int64_t>(kHeader.size())) {
    unlink(file_.c_str());
  }
  Close();
}

void BuildJournal::Close() {
  if (descriptor_ >= 0) {
    close(descriptor_);
    descriptor_ = -1;
  }
}

void BuildJournal::Warn(const std::string& sentence) {
  if (warnings_ != nullptr) {
    *warnings_ << "warning: " << file_.string() << " " << sentence << std::endl;
  }
}

}  // namespace floorloc
